#pragma once

#include "net/base/descriptor.h"
#include "net/base/event_fd.h"
#include "net/ssh/ssh_failures.h"
#include "net/ssh/ssh_process.h"
#include "net/ssh/ssh_target.h"
#include "net/tunnel/multiplexer.h"

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

struct pollfd;

namespace gs::net {

class SocketPump;

/// Settings of a connection to a machine.
struct SshSettings {
  std::string remote_program = "ghostspace";  // as in remote_serve_command()
  std::string version;                        // version of this program
  std::chrono::milliseconds idle{60'000};     // time without connections after which ssh is ended
  std::chrono::milliseconds quiet{20'000};    // as in TunnelTerms
  std::string program = "ssh";
};

/// Connection to one account on one machine: a thread with an ssh process. The process runs `ghostspace serve --stdio`
/// or, if that is missing, the SFTP server. All functions are for any thread.
class SshLink : NonCopyable {
 public:
  using Report = std::function<void(const std::string& message)>;

  /// Starts ssh. `report` receives one-line messages for the user, on the thread of the link; may be empty.
  SshLink(SshTarget target, SshSettings settings, Report report);
  /// Ends ssh.
  ~SshLink();

  /// Returns a socket that is connected to an HTTP server for the files of the machine. It is usable at once; its
  /// requests wait until ssh is connected. Returns an empty descriptor if the link is over.
  [[nodiscard]] Descriptor connect();
  /// Connects the other end of a socket in the same way. Returns false if the link is over.
  [[nodiscard]] bool take(Descriptor socket);
  void set_report(Report report);
  /// Reports whether ssh is still connecting, and may wait for the user.
  [[nodiscard]] bool connecting() const { return connecting_; }
  /// Returns the reason why the link is over; nullopt while it can be used.
  [[nodiscard]] std::optional<SshFailure> failure() const;
  /// Returns the time at which the link was over.
  [[nodiscard]] std::chrono::steady_clock::time_point failed_at() const;
  /// Returns the number of the link, unique in this process.
  [[nodiscard]] std::uint64_t number() const { return number_; }

 private:
  struct Attempt;  // ssh process with its pump
  /// Result of an attempt: how ssh ended, and whether the other end had answered.
  struct Ended {
    std::string why;  // empty if the pipe was closed
    std::optional<int> status;
    std::string errors;
    bool started = false, answered = false, idle = false;
  };

  void run();
  [[nodiscard]] Ended attempt(Multiplexer& multiplexer, const std::function<bool()>& ready, const std::string& command);
  [[nodiscard]] SshFailure failure_of(const Ended& ended) const;
  void connect_waiting(Multiplexer& multiplexer, SocketPump& pump);
  void take_errors(int from, bool answered, std::string& errors);
  void tell(const std::string& message);
  void fail(SshFailure failure);

  const SshTarget target_;
  const SshSettings settings_;
  const std::uint64_t number_;
  EventFd wake_;
  std::atomic<bool> stopping_ = false, connecting_ = true;
  unsigned told_ = 0;         // messages of the other end; used by the thread
  std::string last_line_;     // last message of the other end; used by the thread
  mutable std::mutex mutex_;  // guards the members below
  Report report_;
  std::vector<Descriptor> waiting_;  // sockets without a connection
  std::optional<SshFailure> failure_;
  std::chrono::steady_clock::time_point failed_at_{};
  std::thread thread_;  // last member, because the thread uses the members above
};

/// Links of this process, one per account and remote program. Any thread.
class SshLinks : NonCopyable {
 public:
  /// Returns the links of this process. They end with it.
  [[nodiscard]] static SshLinks& shared();

  /// Returns the link for an account. Starts ssh again if the last link is over, unless it was refused just before.
  [[nodiscard]] std::shared_ptr<SshLink> find(const SshTarget& target, const SshSettings& settings,
                                              SshLink::Report report);
  /// Ends all links.
  void end_all();

 private:
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<SshLink>> links_;
};

}  // namespace gs::net
