"""One run in every format that run files may have, each by the library that users write it with.

In: nothing. Out: run.csv and the same numbers in the other files of this folder, which `tests/formats.rs` reads back bit for bit.
Needs numpy, scipy, h5py, pyarrow, polars. The files are committed; this says where they came from.
"""

import gzip
import pathlib

import h5py
import numpy as np
import polars as pl
import pyarrow as pa
import pyarrow.feather as feather
import pyarrow.parquet as pq
import scipy.io

here = pathlib.Path(__file__).parent
rng = np.random.default_rng(1)
t = np.arange(61) / 50.0


def series(values, std):
    return values + std * rng.standard_normal(t.size)


run = {
    "t_s": t,
    "X_m": series(0.1 * np.sin(0.5 * t), 7.5e-4),
    "Y_m": series(0.05 * np.cos(6.0 * t), 7.5e-4),
    "Z_m": series(0.05 * np.sin(6.0 * t), 7.5e-4),
    "Rx_deg": series(51.0 + 9.0 * t, 0.0623),
    "Ry_deg": series(23.0 * np.cos(6.0 * t), 0.110),
    "Rz_deg": series(23.0 * np.sin(6.0 * t), 0.110),
    "qW_Pa": series(32.6 + 0.4 * np.sin(0.7 * t), 0.02),
    "ps_Pa": np.full(t.size, 101325.0),
    "VW_m_s": series(7.43 + 0.05 * np.sin(0.7 * t), 2.57e-3),
    "Ts_K": np.full(t.size, 299.084),
}
# One value that was not measured.
run["Y_m"][30] = np.nan


def text(separator=",", lines=range(t.size)):
    """Each number with the digits that give it back exactly; nothing where nothing was measured."""
    rows = [separator.join(run)]
    rows += [separator.join("" if np.isnan(c[i]) else repr(float(c[i])) for c in run.values()) for i in lines]
    return "\n".join(rows) + "\n"


(here / "run.csv").write_text(text())
(here / "run.csv.gz").write_bytes(gzip.compress(text().encode(), mtime=0))

scipy.io.savemat(here / "v5.mat", run, oned_as="column")
scipy.io.savemat(here / "v5-compressed.mat", run, do_compression=True, oned_as="row")
scipy.io.savemat(here / "v5-struct.mat", {"note": "one run", "run": run}, do_compression=True, oned_as="column")
scipy.io.savemat(here / "v5-two-structs.mat", {"a": {"t_s": t}, "b": {"t_s": t}}, do_compression=True)
pose = np.column_stack([run["X_m"], run["Y_m"], run["Z_m"]])
rest = {k: v for k, v in run.items() if k not in ("X_m", "Y_m", "Z_m")}
scipy.io.savemat(here / "v5-matrix.mat", {**rest, "pose": pose, "rate_hz": 50.0, "serial": "A7"}, do_compression=True)
scipy.io.savemat(here / "v5-complex.mat", {**run, "X_m": run["X_m"] + 1j}, do_compression=True)


def matlab_73(path, write):
    """The 512 bytes that MATLAB puts before HDF5, then what `write` makes."""
    with h5py.File(path, "w", userblock_size=512, libver=("earliest", "v108")) as f:
        write(f)
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Thu Jan  1 00:00:00 1970 HDF5 schema 1.00 ."
    with open(path, "r+b") as f:
        f.write(head.ljust(116) + bytes(8) + b"\x00\x02IM")


def matlab_vectors(group, compressed=()):
    for name, values in run.items():
        how = {"chunks": (1, 32), "compression": "gzip"} if name in compressed else {}
        d = group.create_dataset(name, data=values.reshape(1, -1), **how)
        d.attrs["MATLAB_class"] = np.bytes_("double")


def matlab_struct(f):
    group = f.create_group("run")
    group.attrs["MATLAB_class"] = np.bytes_("struct")
    matlab_vectors(group, ("t_s", "X_m"))
    note = f.create_dataset("note", data=np.array([[ord(c)] for c in "one run"], dtype="uint16"))
    note.attrs["MATLAB_class"] = np.bytes_("char")


matlab_73(here / "v73.mat", matlab_vectors)
matlab_73(here / "v73-struct.mat", matlab_struct)
with h5py.File(here / "plain.h5", "w") as f:
    for name, values in run.items():
        f.create_dataset(name, data=values)

frame = pl.DataFrame(run)
frame.write_parquet(here / "polars-zstd.parquet", compression="zstd", statistics=False)
table = pa.table(run)
pq.write_table(table, here / "pyarrow-zstd.parquet", compression="zstd", write_statistics=False, store_schema=False)
frame.write_ipc(here / "polars.arrow", compression="uncompressed")
frame.write_ipc(here / "polars-lz4.arrow", compression="lz4")
frame.write_ipc(here / "polars-zstd.arrow", compression="zstd")
feather.write_feather(table, here / "pyarrow-lz4.feather", compression="lz4")
# Integers, floats, nulls instead of NaN, two batches, a column of words.
mixed = pa.table(
    {
        "t_s": pa.array(t),
        "n": pa.array(range(t.size), pa.int32()),
        "f": pa.array(np.arange(t.size, dtype=np.float32)),
        "hole": pa.array([None if i == 30 else float(i) for i in range(t.size)]),
        "phase": pa.array(["free"] * t.size),
        "b": pa.array([i % 3 == 0 for i in range(t.size)]),
    }
)
feather.write_feather(mixed, here / "mixed.feather", compression="uncompressed", chunksize=40)
pq.write_table(mixed, here / "mixed.parquet", compression="zstd", row_group_size=40, store_schema=False)
