#include "app/base/system_calls.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/sched.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::app {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#elif defined(__riscv) && __riscv_xlen == 64
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_RISCV64;
#else
constexpr std::uint32_t kArchitecture = 0;  // unsupported architecture
#endif

// System calls that the headers of Debian 12 lack. Their numbers are the same on all architectures.
constexpr long kFchmodat2 = 452, kSetxattrat = 463, kRemovexattrat = 466, kOpenTreeAttr = 467, kFileSetattr = 469;

// System calls that are refused. A list of allowed calls would not work, because the libraries for C, OpenGL and LLVM
// use different calls in each version. Landlock already restricts files. This list has calls that affect more than
// files, and file operations that Landlock does not control: attributes, and truncation before version 3.
constexpr long kRefused[] = {
    // Network, and communication with other processes
    SYS_socket,
    SYS_socketpair,
    SYS_connect,
    SYS_bind,
    SYS_listen,
    SYS_accept,
    SYS_accept4,
    SYS_sendto,
    SYS_sendmsg,
    SYS_sendmmsg,
    SYS_recvfrom,
    SYS_recvmsg,
    SYS_recvmmsg,
    SYS_setsockopt,
    SYS_io_uring_setup,
    SYS_io_uring_enter,
    SYS_io_uring_register,
    SYS_shmget,
    SYS_shmat,
    SYS_shmctl,
    SYS_msgget,
    SYS_msgsnd,
    SYS_msgrcv,
    SYS_semget,
    SYS_mq_open,
    SYS_mq_unlink,
    // Other programs and processes
    SYS_execve,
    SYS_execveat,
    SYS_ptrace,
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_process_madvise,
    SYS_kcmp,
    SYS_pidfd_open,
    SYS_pidfd_getfd,
    SYS_pidfd_send_signal,
    SYS_tkill,
    SYS_rt_sigqueueinfo,
    SYS_rt_tgsigqueueinfo,
    SYS_setpgid,
    SYS_setsid,
    SYS_setpriority,
    SYS_ioprio_set,
#ifdef SYS_fork
    SYS_fork,
    SYS_vfork,
#endif
    // Attributes of files, and their names
    SYS_fchmod,
    SYS_fchmodat,
    SYS_fchown,
    SYS_fchownat,
    SYS_utimensat,
    SYS_setxattr,
    SYS_lsetxattr,
    SYS_fsetxattr,
    SYS_removexattr,
    SYS_lremovexattr,
    SYS_fremovexattr,
    SYS_truncate,
    SYS_openat2,
    SYS_open_by_handle_at,
    SYS_name_to_handle_at,
    SYS_fanotify_init,
    kFchmodat2,
    kSetxattrat,
    kRemovexattrat,
    kOpenTreeAttr,
    kFileSetattr,
#ifdef SYS_chmod
    SYS_chmod,
    SYS_chown,
    SYS_lchown,
    SYS_utime,
    SYS_utimes,
    SYS_futimesat,
#endif
    // State of the machine.
    SYS_mount,
    SYS_umount2,
    SYS_pivot_root,
    SYS_chroot,
    SYS_move_mount,
    SYS_open_tree,
    SYS_fsopen,
    SYS_fsmount,
    SYS_fspick,
    SYS_fsconfig,
    SYS_mount_setattr,
    SYS_setns,
    SYS_unshare,
    SYS_bpf,
    SYS_perf_event_open,
    SYS_userfaultfd,
    SYS_add_key,
    SYS_request_key,
    SYS_keyctl,
    SYS_init_module,
    SYS_finit_module,
    SYS_delete_module,
    SYS_kexec_load,
    SYS_reboot,
    SYS_swapon,
    SYS_swapoff,
    SYS_acct,
    SYS_quotactl,
    SYS_syslog,
    SYS_personality,
    SYS_settimeofday,
    SYS_clock_settime,
    SYS_clock_adjtime,
    SYS_adjtimex,
    SYS_sethostname,
    SYS_setdomainname,
    SYS_setrlimit,
    SYS_vhangup,
#ifdef SYS_iopl
    SYS_iopl,
    SYS_ioperm,
    SYS_modify_ldt,
#endif
};

// System calls that decoders need. The C library, threads and allocators use them; sanitizers use them, too.
constexpr long kDecoding[] = {
    // Open descriptors
    SYS_read,
    SYS_write,
    SYS_readv,
    SYS_writev,
    SYS_close,
    SYS_lseek,
    SYS_fstat,
    SYS_recvmsg,  // descriptors that the parent sends
    // Memory
    SYS_mmap,
    SYS_munmap,
    SYS_mprotect,
    SYS_mremap,
    SYS_madvise,
    SYS_brk,
    SYS_membarrier,
    // Threads and their end
    SYS_clone,
    SYS_futex,
    SYS_set_robust_list,
    SYS_rseq,
    SYS_sched_yield,
    SYS_sched_getaffinity,
    SYS_gettid,
    SYS_getpid,
    SYS_prctl,
    SYS_exit,
    SYS_exit_group,
    // Signals to this process
    SYS_tgkill,
    SYS_rt_sigaction,
    SYS_rt_sigprocmask,
    SYS_rt_sigreturn,
    SYS_sigaltstack,
    SYS_restart_syscall,
    // Time, random numbers and facts
    SYS_clock_gettime,
    SYS_clock_nanosleep,
    SYS_nanosleep,
    SYS_gettimeofday,
    SYS_getrandom,
    SYS_getrusage,
    SYS_sysinfo,
    SYS_uname,
    SYS_prlimit64,
#ifdef SYS_poll
    SYS_poll,
#endif
    SYS_ppoll,
};

// Builder of a BPF program. Its rules run in order. Each rule ends the program or continues with the next rule.
class Filter {
 public:
  Filter() {
    load(offsetof(seccomp_data, arch));
    jump(BPF_JEQ, kArchitecture, 1, 0);
    finish(SECCOMP_RET_KILL_PROCESS);
    load(offsetof(seccomp_data, nr));
#ifdef __x86_64__
    constexpr std::uint32_t kX32 = 0x40000000;  // bit of x32 calls, which are the same calls with other numbers
    jump(BPF_JGE, kX32, 0, 1);
    finish(kRefuse);
#endif
  }
  void refuse(long call, std::uint32_t answer = kRefuse) {
    jump(BPF_JEQ, static_cast<std::uint32_t>(call), 0, 1);
    finish(answer);
  }
  /// Refuses a call if, among the bits of `mask`, exactly `bits` are set in the argument, or `unless` they are.
  void refuse_bits(long call, unsigned argument, std::uint32_t mask, std::uint32_t bits, bool unless = false) {
    begin(call, 5);
    load(low_word(argument));
    step(BPF_ALU | BPF_AND | BPF_K, mask);
    jump(BPF_JEQ, bits, unless, !unless);
    finish(kRefuse);
    load(offsetof(seccomp_data, nr));
  }
  /// Refuses a call unless all of `bits` are set in the argument.
  void require_bits(long call, unsigned argument, std::uint32_t bits) { refuse_bits(call, argument, bits, bits, true); }
  /// Refuses a call unless the argument equals `number`.
  void require(long call, unsigned argument, std::uint32_t number) {
    begin(call, 6);
    load(low_word(argument));
    jump(BPF_JEQ, number, 0, 2);
    load(high_word(argument));
    jump(BPF_JEQ, 0, 1, 0);
    finish(kRefuse);
    load(offsetof(seccomp_data, nr));
  }
  void allow(long call) {
    jump(BPF_JEQ, static_cast<std::uint32_t>(call), 0, 1);
    finish(SECCOMP_RET_ALLOW);
  }
  /// Applies the filter. `otherwise` is the answer to calls that no rule decides.
  [[nodiscard]] bool apply(std::uint32_t otherwise = SECCOMP_RET_ALLOW) {
    finish(otherwise);
    sock_fprog program{static_cast<unsigned short>(steps_.size()), steps_.data()};
    return ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_TSYNC, &program) == 0;
  }

  static constexpr std::uint32_t kRefuse = SECCOMP_RET_ERRNO | EPERM, kUnknown = SECCOMP_RET_ERRNO | ENOSYS;

 private:
  void step(unsigned code, std::uint32_t value, unsigned yes = 0, unsigned no = 0) {
    steps_.push_back(
        {static_cast<std::uint16_t>(code), static_cast<std::uint8_t>(yes), static_cast<std::uint8_t>(no), value});
  }
  void load(std::size_t offset) { step(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)); }
  void jump(unsigned test, std::uint32_t value, unsigned yes, unsigned no) {
    step(BPF_JMP | test | BPF_K, value, yes, no);
  }
  void finish(std::uint32_t answer) { step(BPF_RET | BPF_K, answer); }
  // Begins a rule of `length` instructions for one call. All other calls skip these instructions.
  void begin(long call, unsigned length) { jump(BPF_JEQ, static_cast<std::uint32_t>(call), 0, length); }
  static std::size_t word(unsigned argument, bool high) {
    const bool second = high == (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);
    return offsetof(seccomp_data, args) + argument * sizeof(std::uint64_t) + (second ? sizeof(std::uint32_t) : 0);
  }
  static std::size_t low_word(unsigned argument) { return word(argument, false); }
  static std::size_t high_word(unsigned argument) { return word(argument, true); }

  std::vector<sock_filter> steps_;
};

}  // namespace

bool can_refuse_calls() {
  std::uint32_t action = SECCOMP_RET_KILL_PROCESS;
  return kArchitecture != 0 && ::syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
}

static bool allow_child_calls(bool makes_code) {
  Filter filter;
  filter.refuse(SYS_clone3, Filter::kUnknown);
  filter.require_bits(SYS_clone, 0, CLONE_THREAD);
  filter.require(SYS_tgkill, 0, static_cast<std::uint32_t>(::getpid()));
  filter.require(SYS_prlimit64, 2, 0);
  filter.require(SYS_prctl, 0, PR_SET_NAME);  // SpiderMonkey ends the process if a thread cannot set its name
  if (!makes_code) {
    filter.refuse_bits(SYS_mmap, 2, PROT_EXEC, PROT_EXEC);
    filter.refuse_bits(SYS_mprotect, 2, PROT_EXEC, PROT_EXEC);
  }
  filter.refuse_bits(SYS_mmap, 3, MAP_SHARED | MAP_ANONYMOUS, MAP_SHARED | MAP_ANONYMOUS);
  for (const long call : kDecoding) filter.allow(call);
  return filter.apply(Filter::kRefuse);
}

bool allow_decoding_calls() { return allow_child_calls(false); }
bool allow_program_calls() { return allow_child_calls(true); }

bool refuse_calls() {
  Filter filter;
  for (const long call : kRefused) filter.refuse(call);
  // Threads are allowed, processes are not. A filter cannot read the flags of clone3, so clone3 fails as unknown and
  // libc uses clone.
  filter.refuse(SYS_clone3, Filter::kUnknown);
  filter.require_bits(SYS_clone, 0, CLONE_THREAD);
  // Signals may go only to this process. Limits may be read, not set.
  const auto self = static_cast<std::uint32_t>(::getpid());
  filter.require(SYS_kill, 0, self);
  filter.require(SYS_tgkill, 0, self);
  filter.require(SYS_prlimit64, 2, 0);
  // Before version 3, Landlock allowed to truncate readable files in this way.
  filter.refuse_bits(SYS_openat, 2, O_ACCMODE | O_TRUNC, O_RDONLY | O_TRUNC);
#ifdef SYS_open
  filter.refuse_bits(SYS_open, 1, O_ACCMODE | O_TRUNC, O_RDONLY | O_TRUNC);
#endif
  // Shared memory does not count towards the limits of a process.
  filter.refuse(SYS_memfd_create);
  filter.refuse_bits(SYS_mmap, 3, MAP_SHARED | MAP_ANONYMOUS, MAP_SHARED | MAP_ANONYMOUS);
  return filter.apply();
}

}  // namespace gs::app
