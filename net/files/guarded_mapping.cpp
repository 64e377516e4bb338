#include "net/files/guarded_mapping.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <mutex>
#include <utility>

#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace gs::net {

/// Address range of a mapping, for the signal handler, which may run at any moment on any thread. Ranges are reused and
/// never freed. `version` is odd during a change, so that the handler does not mix old and new values.
struct GuardedRange {
  std::atomic<std::uint64_t> version{0};
  std::atomic<std::uintptr_t> begin{0}, end{0};  // addresses of whole pages; 0 means free
  std::atomic<bool> lost{false};
  GuardedRange* next = nullptr;  // set once, before the range joins the list
};

namespace {

static_assert(std::atomic<std::uintptr_t>::is_always_lock_free && std::atomic<std::uint64_t>::is_always_lock_free,
              "a signal handler must not wait for a lock");

std::atomic<GuardedRange*> guarded_ranges{nullptr};
std::mutex guarded_mutex;  // for acquiring and releasing ranges; not for the handler
struct sigaction previous_bus_action {};
std::uintptr_t guarded_page_size = 0;

#ifdef SYS_mmap2
constexpr long kMapCall = SYS_mmap2;
#else
constexpr long kMapCall = SYS_mmap;
#endif

// Maps zeros from `at` to the end of its range. Uses system calls without wrappers: signal handlers may call few
// functions, and ThreadSanitizer would report mmap(2) as a data race. Returns false if no range contains `at`.
bool fill_missing(std::uintptr_t at) {
  for (GuardedRange* range = guarded_ranges.load(std::memory_order_acquire); range; range = range->next) {
    const std::uint64_t version = range->version.load(std::memory_order_acquire);
    const std::uintptr_t begin = range->begin.load(std::memory_order_acquire),
                         end = range->end.load(std::memory_order_acquire);
    if (version % 2 != 0 || range->version.load(std::memory_order_acquire) != version) continue;
    if (at < begin || at >= end) continue;
    const std::uintptr_t page = at & ~(guarded_page_size - 1);
    range->lost.store(true, std::memory_order_release);
    return ::syscall(kMapCall, page, end - page, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1,
                     0) != -1;
  }
  return false;
}

void on_bus_error(int number, siginfo_t* info, void* context) {
  const int saved = errno;
  if (info->si_code == BUS_ADRERR && fill_missing(reinterpret_cast<std::uintptr_t>(info->si_addr))) {
    errno = saved;
    return;
  }
  errno = saved;
  if ((previous_bus_action.sa_flags & SA_SIGINFO) != 0) return previous_bus_action.sa_sigaction(number, info, context);
  if (previous_bus_action.sa_handler != SIG_DFL && previous_bus_action.sa_handler != SIG_IGN)
    return previous_bus_action.sa_handler(number);
  // Restore the default action. The faulting access is then repeated and ends the program.
  struct sigaction standard {};
  standard.sa_handler = SIG_DFL;
  (void)::sigaction(SIGBUS, &standard, nullptr);
}

// Installs the handler of SIGBUS. The caller must hold guarded_mutex.
bool install_handler() {
  static bool installed = false;
  if (installed) return true;
  guarded_page_size = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  struct sigaction action {};
  action.sa_sigaction = on_bus_error;
  action.sa_flags = static_cast<int>(SA_SIGINFO | SA_ONSTACK);
  sigemptyset(&action.sa_mask);
  installed = ::sigaction(SIGBUS, nullptr, &previous_bus_action) == 0 && ::sigaction(SIGBUS, &action, nullptr) == 0;
  return installed;
}

void change_range(GuardedRange& range, std::uintptr_t begin, std::uintptr_t end) {
  range.version.fetch_add(1, std::memory_order_acq_rel);
  range.begin.store(begin, std::memory_order_release);
  range.end.store(end, std::memory_order_release);
  range.lost.store(false, std::memory_order_release);
  range.version.fetch_add(1, std::memory_order_acq_rel);
}

// Returns an unused range. The caller must hold guarded_mutex.
GuardedRange& free_range() {
  for (GuardedRange* range = guarded_ranges.load(std::memory_order_acquire); range; range = range->next)
    if (range->end.load(std::memory_order_acquire) == 0) return *range;
  auto* range = new GuardedRange;
  range->next = guarded_ranges.load(std::memory_order_acquire);
  guarded_ranges.store(range, std::memory_order_release);
  return *range;
}

}  // namespace

std::optional<GuardedMapping> GuardedMapping::of(int file, std::size_t size) {
  const std::lock_guard lock(guarded_mutex);
  if (size == 0 || !install_handler()) return std::nullopt;
  GuardedRange& range = free_range();  // may throw, so it must precede the mapping
  void* const memory = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  if (memory == MAP_FAILED) return std::nullopt;
  const auto begin = reinterpret_cast<std::uintptr_t>(memory);
  change_range(range, begin, begin + (size + guarded_page_size - 1) / guarded_page_size * guarded_page_size);
  GuardedMapping mapping;
  mapping.data_ = static_cast<const std::byte*>(memory);
  mapping.size_ = size;
  mapping.range_ = &range;
  return mapping;
}

GuardedMapping::GuardedMapping(GuardedMapping&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      range_(std::exchange(other.range_, nullptr)) {}

GuardedMapping& GuardedMapping::operator=(GuardedMapping&& other) noexcept {
  if (this == &other) return *this;
  release();
  data_ = std::exchange(other.data_, nullptr);
  size_ = std::exchange(other.size_, 0);
  range_ = std::exchange(other.range_, nullptr);
  return *this;
}

GuardedMapping::~GuardedMapping() { release(); }

void GuardedMapping::release() noexcept {
  if (!range_) return;
  const std::lock_guard lock(guarded_mutex);
  change_range(*range_, 0, 0);
  ::munmap(const_cast<std::byte*>(data_), size_);
}

void GuardedMapping::put_aside(std::size_t size) const {
  const std::size_t whole = std::min(size, size_) & ~static_cast<std::size_t>(guarded_page_size - 1);
  // After a loss, keep the pages: dropping them would also drop the zeros.
  if (whole > 0 && !lost()) (void)::madvise(const_cast<std::byte*>(data_), whole, MADV_DONTNEED);
}

bool GuardedMapping::lost() const { return range_ && range_->lost.load(std::memory_order_acquire); }

}  // namespace gs::net
