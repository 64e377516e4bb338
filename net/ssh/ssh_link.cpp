#include "net/ssh/ssh_link.h"

#include "net/ssh/sftp_site.h"
#include "net/tunnel/socket_pump.h"
#include "net/tunnel/tunnel_session.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

namespace gs::net {
namespace {

using SteadyTime = std::chrono::steady_clock::time_point;
using namespace std::chrono_literals;

constexpr std::size_t kMaxErrors = std::size_t{8} << 10;
/// Maximum messages of the other end that are shown.
constexpr unsigned kMaxTold = 50;
constexpr std::size_t kMaxWaitingSockets = 64;
/// Time for ssh to end by itself.
constexpr std::chrono::milliseconds kEndPatience{1000};
/// Time in which a refused account is not asked again.
constexpr std::chrono::milliseconds kRefusedFor{5000};

std::uint64_t next_number() {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

// Writing to a pipe without a reader then returns an error on this thread.
void block_broken_pipes() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

std::string install_hint(const SshTarget& target) {
  const std::string to = target.user.empty() ? target.host : target.user + "@" + target.host;
  const std::string ssh_port = target.port ? "-p " + std::to_string(*target.port) + " " : std::string();
  const std::string scp_port = target.port ? "-P " + std::to_string(*target.port) + " " : std::string();
  return "ssh " + ssh_port + to + " mkdir -p .local/bin && scp " + scp_port + "\"$(command -v ghostspace)\" " + to +
         ":.local/bin/ (works only with the libraries of this machine there)";
}

}  // namespace

SshLink::SshLink(SshTarget target, SshSettings settings, Report report)
    : target_(std::move(target)),
      settings_(std::move(settings)),
      number_(next_number()),
      report_(std::move(report)),
      thread_([this] { run(); }) {}

SshLink::~SshLink() {
  stopping_ = true;
  wake_.ring();
  thread_.join();
}

Descriptor SshLink::connect() {
  auto [ours, theirs] = socket_pair();
  return theirs && take(std::move(theirs)) ? std::move(ours) : Descriptor();
}

bool SshLink::take(Descriptor socket) {
  {
    const std::lock_guard lock(mutex_);
    if (failure_ || waiting_.size() >= kMaxWaitingSockets) return false;
    waiting_.push_back(std::move(socket));
  }
  wake_.ring();
  return true;
}

void SshLink::set_report(Report report) {
  const std::lock_guard lock(mutex_);
  report_ = std::move(report);
}

std::optional<SshFailure> SshLink::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

SteadyTime SshLink::failed_at() const {
  const std::lock_guard lock(mutex_);
  return failed_at_;
}

void SshLink::tell(const std::string& message) {
  Report report;
  {
    const std::lock_guard lock(mutex_);
    report = report_;
  }
  if (report) report("ssh://" + target_.text() + ": " + message);
}

void SshLink::fail(SshFailure failure) {
  connecting_ = false;
  const std::lock_guard lock(mutex_);
  failure_ = std::move(failure);
  failed_at_ = std::chrono::steady_clock::now();
  waiting_.clear();  // closes the sockets: their transfers see the failure
}

SshFailure SshLink::failure_of(const Ended& ended) const {
  using Kind = SshFailure::Kind;
  if (ended.idle) return {Kind::idle, "the connection was not used"};
  if (!ended.started) return {Kind::unusable, ended.why + "; install it (Debian: openssh-client)"};
  if (!ended.why.empty() && ended.answered) return {Kind::broken, ended.why};
  if (!ended.why.empty()) return {Kind::unusable, ended.why};
  if (ended.answered && ended.status && *ended.status != kSshStatus)
    return {Kind::broken, "the program there has ended" + (last_line_.empty() ? std::string() : ": " + last_line_)};
  return explain_ssh(ended.errors, ended.status, target_.text());
}

void SshLink::run() {
  block_broken_pipes();
  TunnelTerms terms;
  terms.version = settings_.version;
  terms.quiet = settings_.quiet;
  TunnelSession tunnel(terms, std::chrono::steady_clock::now());
  const Ended first = attempt(
      tunnel, [&tunnel] { return tunnel.ready(); }, remote_serve_command(settings_.remote_program));
  if (stopping_) return;
  const SshFailure failure = failure_of(first);
  const bool ran = (first.status && *first.status != kSshStatus) || !first.why.empty();
  // A machine that allows only SFTP may end the connection without an explanation.
  if (!first.started || first.answered || (!ran && failure.kind != SshFailure::Kind::broken)) return fail(failure);
  // The machine was reached, but GhostSpace did not answer.
  constexpr int kNotFound = 127;
  const std::string line = last_line_of(first.errors);
  const std::string why = first.status == kNotFound && first.errors.find("shared librar") == std::string::npos &&
                                  settings_.remote_program == SshSettings().remote_program
                              ? "GhostSpace is not installed there; install it with: " + install_hint(target_)
                          : !first.why.empty() ? first.why
                          : !ran               ? failure.message
                                               : settings_.remote_program + " fails there with status " +
                                       std::to_string(first.status.value_or(0)) + (line.empty() ? "" : ": " + line);
  SftpSite site(std::chrono::steady_clock::now());
  bool told = false;
  const Ended second = attempt(site,
                               [&] {
                                 if (site.ready() && !std::exchange(told, true))
                                   tell(why + "; until then, files are read by SFTP, without thumbnails and encoding");
                                 return site.ready();
                               },
                               {});
  if (stopping_) return;
  SshFailure last = failure_of(second);
  if (ran && !second.answered && second.started &&
      (last.kind == SshFailure::Kind::broken || last.kind == SshFailure::Kind::unusable))
    last = {SshFailure::Kind::unusable, why + "; SFTP does not work there, either"};
  fail(std::move(last));
}

SshLink::Ended SshLink::attempt(Multiplexer& multiplexer, const std::function<bool()>& ready,
                                const std::string& command) {
  Ended ended;
  auto made = SshProcess::start(settings_.program, ssh_arguments(target_, command, ssh_cannot_ask()));
  if (const auto* problem = std::get_if<std::string>(&made)) {
    ended.why = *problem;
    return ended;
  }
  ended.started = true;
  SshProcess& ssh = std::get<SshProcess>(made);
  (void)::fcntl(ssh.errors(), F_SETFL, ::fcntl(ssh.errors(), F_GETFL) | O_NONBLOCK);
  SocketPump pump(ssh.output(), ssh.input());
  SteadyTime used = std::chrono::steady_clock::now();
  std::optional<std::string> over;
  bool has_errors = true;
  while (!over && !stopping_) {
    std::vector<pollfd> others{{wake_.descriptor(), POLLIN, 0}, {has_errors ? ssh.errors() : -1, POLLIN, 0}};
    over = pump.step(multiplexer, std::min(settings_.idle, 60'000ms), others);
    wake_.still();
    take_errors(ssh.errors(), ended.answered, ended.errors);
    if ((others[1].revents & POLLHUP) != 0 && (others[1].revents & POLLIN) == 0) has_errors = false;
    if (!ended.answered && ready()) {
      ended.answered = true;
      ended.errors.clear();
      connecting_ = false;
    }
    if (!ended.answered) continue;
    connect_waiting(multiplexer, pump);
    const SteadyTime now = std::chrono::steady_clock::now();
    if (pump.connections() > 0) used = now;
    ended.idle = !over && now - used >= settings_.idle;
    if (ended.idle) break;
  }
  ended.why = over.value_or("");
  ended.status = ssh.end(kEndPatience);
  take_errors(ssh.errors(), ended.answered, ended.errors);
  // After a failure, transfers must find it when their sockets close.
  if (ended.answered && !stopping_) fail(failure_of(ended));
  return ended;
}

void SshLink::connect_waiting(Multiplexer& multiplexer, SocketPump& pump) {
  std::vector<Descriptor> waiting;
  {
    const std::lock_guard lock(mutex_);
    waiting.swap(waiting_);
  }
  for (Descriptor& socket : waiting)
    if (const auto id = multiplexer.open()) pump.add(id, std::move(socket));
}

/// Reads messages of ssh and of the remote program. Shows those of the program, line by line.
void SshLink::take_errors(int from, bool answered, std::string& errors) {
  std::array<char, 4096> block;
  for (;;) {
    const ssize_t got = ::read(from, block.data(), block.size());
    if (got <= 0) break;
    errors.append(block.data(), static_cast<std::size_t>(got));
    if (errors.size() > kMaxErrors) errors.erase(0, errors.size() - kMaxErrors);
  }
  if (!answered) return;
  for (std::size_t end; (end = errors.find('\n')) != std::string::npos;) {
    const std::string line = clean_line(std::string_view(errors).substr(0, end));
    errors.erase(0, end + 1);
    if (line.empty()) continue;
    if (told_++ < kMaxTold) tell(line);
    last_line_ = line;
  }
}

SshLinks& SshLinks::shared() {
  static SshLinks links;
  return links;
}

std::shared_ptr<SshLink> SshLinks::find(const SshTarget& target, const SshSettings& settings, SshLink::Report report) {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<SshLink>& link = links_[target.text() + " " + settings.remote_program];
  const auto failure = link ? link->failure() : std::nullopt;
  const bool lasts = failure &&
                     (failure->kind == SshFailure::Kind::refused || failure->kind == SshFailure::Kind::unusable) &&
                     std::chrono::steady_clock::now() - link->failed_at() < kRefusedFor;
  if (link && (!failure || lasts)) {
    link->set_report(std::move(report));
  } else {
    link.reset();  // its thread is over
    link = std::make_shared<SshLink>(target, settings, std::move(report));
  }
  return link;
}

void SshLinks::end_all() {
  std::map<std::string, std::shared_ptr<SshLink>> links;
  {
    const std::lock_guard lock(mutex_);
    links.swap(links_);
  }
}

}  // namespace gs::net
