#pragma once

namespace gs {

/// Returns freed memory to the system, where the allocator would keep it. Call it after work that freed much. Takes
/// milliseconds.
void return_freed_memory();

/// From now on, returns large pieces of memory to the system as soon as they are freed. Without this, the pieces of
/// growing data leave gaps, which take a third more memory.
void return_large_pieces();

}  // namespace gs
