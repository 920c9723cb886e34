//! Memory that is freed stays with the process.

/// The largest block whose release glibc takes for a measure (32 MiB with its head): `M_MMAP_THRESHOLD` in mallopt(3).
const LARGEST: usize = (32 << 20) - (64 << 10);

/// Has the allocator keep up to 64 MiB of what is freed.
///
/// glibc returns free memory to the system where there is more than twice the largest block that was freed so far. Runs of a study free
/// recordings of some megabytes, and those that follow would have theirs zeroed and mapped anew, page by page. A large block that is freed at
/// once moves that measure, and is never touched. Other allocators lose nothing by it.
pub(crate) fn keep_freed() {
    drop(std::hint::black_box(Vec::<u8>::with_capacity(LARGEST)));
}
