#include "base/free_memory.h"

#include <cstdlib>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace gs {

void return_freed_memory() {
#ifdef __GLIBC__
  (void)malloc_trim(0);
#endif
}

void return_large_pieces() {
#ifdef __GLIBC__
  constexpr int kLarge = 512 << 10, kMostArenas = 2;
  (void)mallopt(M_MMAP_THRESHOLD, kLarge);
  (void)mallopt(M_ARENA_MAX, kMostArenas);
#endif
}

}  // namespace gs
