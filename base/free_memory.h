#pragma once

namespace gs {

/// Returns freed memory to the system, where the allocator would keep it. Call it after work that freed much. Takes
/// milliseconds.
void return_freed_memory();

}  // namespace gs
