//! scenarios: what tells one input from another. In: bytes. Out: a hash.

/// Offset basis of FNV-1a, 64 bits (Fowler, Noll and Vo 1991).
pub(crate) const FNV_BASIS: u64 = 0xcbf2_9ce4_8422_2325;

/// FNV-1a, 64 bits.
pub(crate) fn fnv1a(bytes: &[u8]) -> u64 {
    fnv1a_from(FNV_BASIS, bytes)
}

/// FNV-1a going on from the hash of what came before; the factor is the prime of Fowler, Noll and Vo.
pub(crate) fn fnv1a_from(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, b| (hash ^ u64::from(*b)).wrapping_mul(0x0000_0100_0000_01b3))
}
