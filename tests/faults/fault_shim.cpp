// Library for LD_PRELOAD that makes one call of a program fail, or all from that one on, or kills the program there.
//
//   GHOSTSPACE_FAULT="KIND NUMBER [onwards|kill]" GHOSTSPACE_FAULT_COUNT=FILE LD_PRELOAD=fault_shim.so PROGRAM ...
//
// Calls of KIND are numbered from 1 on; with 0 none fails. KIND is `allocate` (std::bad_alloc or null), `read` (EIO),
// `write` (ENOSPC), `open` (EMFILE) or `connect` (ECONNREFUSED). Calls count from main() on. Allocations count if the
// program itself makes them, because the libraries of OpenGL end the process without memory. Calls for descriptors 0
// to 2 never fail. FILE gets the number of calls, as a native u64, also if the program is killed.
#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* old, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
}

namespace {

enum class Kind { none, allocate, read, write, open, connect };

struct Plan {
  Kind kind = Kind::none;
  std::uint64_t number = 0;
  bool onwards = false, kills = false;
  std::uintptr_t first = 0, last = 0;  // addresses of the program's code
  std::atomic<std::uint64_t>* count = nullptr;
};
Plan plan;
std::atomic<std::uint64_t> own_count;
std::atomic<bool> ready;

int note_program(dl_phdr_info* info, std::size_t, void*) {
  for (int i = 0; i < info->dlpi_phnum; ++i) {
    const auto& part = info->dlpi_phdr[i];
    if (part.p_type != PT_LOAD || (part.p_flags & PF_X) == 0) continue;
    plan.first = info->dlpi_addr + part.p_vaddr;
    plan.last = plan.first + part.p_memsz;
  }
  return 1;  // the first object is the program
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

__attribute__((constructor)) void start() {
  plan.count = &own_count;
  const char* const text = std::getenv("GHOSTSPACE_FAULT");
  if (!text) return;
  char kind[16] = {}, more[16] = {};
  unsigned long long number = 0;
  if (std::sscanf(text, "%15s %llu %15s", kind, &number, more) < 2) return;
  dl_iterate_phdr(note_program, nullptr);
  if (const char* const path = std::getenv("GHOSTSPACE_FAULT_COUNT")) {
    const int file = next<int (*)(const char*, int, ...)>("open")(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file >= 0 && ftruncate(file, 8) == 0) {
      void* const at = mmap(nullptr, 8, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
      if (at != MAP_FAILED) plan.count = static_cast<std::atomic<std::uint64_t>*>(at);
    }
    if (file >= 0) close(file);
  }
  constexpr const char* kNames[] = {"", "allocate", "read", "write", "open", "connect"};
  for (int i = 1; i < 6; ++i)
    if (std::strcmp(kind, kNames[i]) == 0) plan.kind = static_cast<Kind>(i);
  plan.number = number;
  plan.onwards = std::strcmp(more, "onwards") == 0;
  plan.kills = std::strcmp(more, "kill") == 0;
}

using Main = int (*)(int, char**, char**);
Main program_main;

int counted_main(int count, char** arguments, char** environment) {
  ready = plan.kind != Kind::none;
  return program_main(count, arguments, environment);
}

// Counts a call. Returns true if it must fail.
bool fails(Kind kind) {
  if (!ready.load(std::memory_order_relaxed) || plan.kind != kind) return false;
  const std::uint64_t number = ++*plan.count;
  const bool now = plan.number != 0 && (plan.onwards ? number >= plan.number : number == plan.number);
  if (now && plan.kills) (void)::raise(SIGKILL);
  return now;
}

bool fails_for(const void* caller) {
  const auto at = reinterpret_cast<std::uintptr_t>(caller);
  return at >= plan.first && at < plan.last && fails(Kind::allocate);
}

bool fails_on(Kind kind, int file, int error) {
  if (file <= 2 || !fails(kind)) return false;
  errno = error;
  return true;
}

void* allocate(std::size_t bytes, std::size_t alignment, const void* caller) {
  if (fails_for(caller)) return nullptr;
  return alignment > 0 ? __libc_memalign(alignment, std::max<std::size_t>(bytes, 1))
                       : __libc_malloc(std::max<std::size_t>(bytes, 1));
}
void* allocate_or_throw(std::size_t bytes, std::size_t alignment, const void* caller) {
  if (void* const at = allocate(bytes, alignment, caller)) return at;
  throw std::bad_alloc();
}

}  // namespace

#define CALLER __builtin_return_address(0)

void* operator new(std::size_t bytes) { return allocate_or_throw(bytes, 0, CALLER); }
void* operator new[](std::size_t bytes) { return allocate_or_throw(bytes, 0, CALLER); }
void* operator new(std::size_t bytes, std::align_val_t to) {
  return allocate_or_throw(bytes, static_cast<std::size_t>(to), CALLER);
}
void* operator new[](std::size_t bytes, std::align_val_t to) {
  return allocate_or_throw(bytes, static_cast<std::size_t>(to), CALLER);
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept { return allocate(bytes, 0, CALLER); }
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept { return allocate(bytes, 0, CALLER); }

extern "C" {

int __libc_start_main(Main main, int count, char** arguments, void (*init)(), void (*fini)(), void (*end)(),
                      void* stack) {
  program_main = main;
  return next<int (*)(Main, int, char**, void (*)(), void (*)(), void (*)(), void*)>("__libc_start_main")(
      counted_main, count, arguments, init, fini, end, stack);
}

void* malloc(std::size_t bytes) {
  if (!fails_for(CALLER)) return __libc_malloc(bytes);
  errno = ENOMEM;
  return nullptr;
}
void* calloc(std::size_t count, std::size_t bytes) {
  if (!fails_for(CALLER)) return __libc_calloc(count, bytes);
  errno = ENOMEM;
  return nullptr;
}
void* realloc(void* old, std::size_t bytes) {
  if (!fails_for(CALLER)) return __libc_realloc(old, bytes);
  errno = ENOMEM;
  return nullptr;
}

#define FORWARD(name, kind, error, failed, result, parameters, arguments, file)        \
  result name parameters {                                                             \
    static const auto real = next<result(*) parameters>(#name);                        \
    return fails_on(kind, file, error) ? static_cast<result>(failed) : real arguments; \
  }
FORWARD(read, Kind::read, EIO, -1, ssize_t, (int file, void* to, std::size_t bytes), (file, to, bytes), file)
FORWARD(pread, Kind::read, EIO, -1, ssize_t, (int file, void* to, std::size_t bytes, off_t at), (file, to, bytes, at),
        file)
FORWARD(pread64, Kind::read, EIO, -1, ssize_t, (int file, void* to, std::size_t bytes, off64_t at),
        (file, to, bytes, at), file)
FORWARD(readv, Kind::read, EIO, -1, ssize_t, (int file, const iovec* to, int count), (file, to, count), file)
FORWARD(write, Kind::write, ENOSPC, -1, ssize_t, (int file, const void* from, std::size_t bytes), (file, from, bytes),
        file)
FORWARD(pwrite, Kind::write, ENOSPC, -1, ssize_t, (int file, const void* from, std::size_t bytes, off_t at),
        (file, from, bytes, at), file)
FORWARD(pwrite64, Kind::write, ENOSPC, -1, ssize_t, (int file, const void* from, std::size_t bytes, off64_t at),
        (file, from, bytes, at), file)
FORWARD(writev, Kind::write, ENOSPC, -1, ssize_t, (int file, const iovec* from, int count), (file, from, count), file)
FORWARD(ftruncate, Kind::write, ENOSPC, -1, int, (int file, off_t bytes), (file, bytes), file)
FORWARD(ftruncate64, Kind::write, ENOSPC, -1, int, (int file, off64_t bytes), (file, bytes), file)
FORWARD(fsync, Kind::write, EIO, -1, int, (int file), (file), file)
FORWARD(connect, Kind::connect, ECONNREFUSED, -1, int, (int file, const sockaddr* to, socklen_t bytes),
        (file, to, bytes), file)
FORWARD(fread, Kind::read, EIO, 0, std::size_t, (void* to, std::size_t bytes, std::size_t count, FILE* file),
        (to, bytes, count, file), fileno(file))
FORWARD(fwrite, Kind::write, ENOSPC, 0, std::size_t,
        (const void* from, std::size_t bytes, std::size_t count, FILE* file), (from, bytes, count, file), fileno(file))
FORWARD(fopen, Kind::open, EMFILE, nullptr, FILE*, (const char* path, const char* mode), (path, mode), 3)
FORWARD(fopen64, Kind::open, EMFILE, nullptr, FILE*, (const char* path, const char* mode), (path, mode), 3)
FORWARD(rename, Kind::write, ENOSPC, -1, int, (const char* from, const char* to), (from, to), 3)
FORWARD(mkstemp64, Kind::open, EMFILE, -1, int, (char* pattern), (pattern), 3)
FORWARD(mkstemp, Kind::open, EMFILE, -1, int, (char* pattern), (pattern), 3)

// Declares open() and its like. Their last parameter may be missing.
#define FORWARD_OPEN(name, parameters, arguments)                                        \
  int name parameters {                                                                  \
    va_list rest;                                                                        \
    va_start(rest, flags);                                                               \
    const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0; \
    va_end(rest);                                                                        \
    static const auto real = next<int(*) parameters>(#name);                             \
    return fails_on(Kind::open, 3, EMFILE) ? -1 : real arguments;                        \
  }
FORWARD_OPEN(open, (const char* path, int flags, ...), (path, flags, mode))
FORWARD_OPEN(open64, (const char* path, int flags, ...), (path, flags, mode))
FORWARD_OPEN(openat, (int folder, const char* path, int flags, ...), (folder, path, flags, mode))
FORWARD_OPEN(openat64, (int folder, const char* path, int flags, ...), (folder, path, flags, mode))

}  // extern "C"
