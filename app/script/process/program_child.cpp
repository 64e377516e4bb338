#include "app/script/process/program_child.h"

#include "app/base/confinement.h"
#include "app/base/exit_status.h"
#include "app/script/boundary/message.h"
#include "app/script/process/channel.h"

#include <chrono>
#include <csignal>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

namespace gs::app::script {
namespace {

constexpr int kChannelFile = 3;
constexpr rlim_t kMostChildMemory = rlim_t{3} << 30;
constexpr std::size_t kMostOrder = std::size_t{1} << 31;    // bytes; the world decides the size of orders
constexpr std::chrono::milliseconds kMostOfMessage{5};      // time after which the rest of a message is skipped
constexpr std::size_t kKeptNotices = std::size_t{1} << 18;  // bytes of notices that wait for a question

bool limit_child() {
  const auto set = [](__rlimit_resource which, rlim_t most) {
    const rlimit both{most, most};
    return ::setrlimit(which, &both) == 0;
  };
  bool good = set(RLIMIT_FSIZE, 0) && set(RLIMIT_CORE, 0);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // sanitizers need terabytes of address space
  good = good && set(RLIMIT_DATA, kMostChildMemory);
#endif
  return good;
}

// Ends the child. Destructors and leak checks need calls that are refused now.
[[noreturn]] void end_here() { ::_exit(kDone); }

/// World at the other end of the channel.
class RemoteWorld final : public WorldAccess {
 public:
  explicit RemoteWorld(Channel& channel) : channel_(channel) {}

  [[nodiscard]] Answer ask(const Question& question) override {
    write(writer_, question);
    send();
    receive();
    MessageReader reader(message_);
    if (reader.number<std::uint8_t>() != static_cast<std::uint8_t>(ItemKind::answer)) end_here();
    Answer answer = read_answer(reader);
    if (!reader.good()) end_here();
    return answer;
  }
  void tell(const Notice& notice) override {
    write(writer_, notice);
    if (writer_.bytes().size() > kKeptNotices) send();
  }

  [[nodiscard]] Order next_order() {
    if (orders_.empty()) receive_orders();
    channel_.set_progress(++begun_);
    Order order = std::move(orders_.front());
    orders_.pop_front();
    return order;
  }
  // Reports of one message travel together.
  void report(const Report& report) {
    write(writer_, report);
    if (!orders_.empty() && std::chrono::steady_clock::now() - received_ > kMostOfMessage) {
      Report skipped;
      skipped.skipped = true;
      for (; !orders_.empty(); orders_.pop_front()) write(writer_, skipped);
    }
    if (orders_.empty()) send();
  }

 private:
  void receive_orders() {
    receive();
    MessageReader reader(message_);
    do {
      if (reader.number<std::uint8_t>() != static_cast<std::uint8_t>(ItemKind::order)) end_here();
      orders_.push_back(read_order(reader));
      if (!reader.good()) end_here();
    } while (!reader.at_end());
    begun_ = 0;
    received_ = std::chrono::steady_clock::now();
  }
  void send() {
    if (!channel_.send(writer_.bytes())) end_here();
    writer_.clear();
  }
  void receive() {
    if (!channel_.receive(message_, kMostOrder)) end_here();
  }

  Channel& channel_;
  MessageWriter writer_;
  std::vector<std::byte> message_;
  std::deque<Order> orders_;  // of the last message, not yet run
  std::uint32_t begun_ = 0;   // number of its orders that were begun
  std::chrono::steady_clock::time_point received_;
};

}  // namespace

void run_program_child(std::string_view mode) {
  (void)std::signal(SIGPIPE, SIG_IGN);
  (void)std::signal(SIGINT, SIG_IGN);  // Ctrl-C on the terminal is for the parent
  (void)::prctl(PR_SET_DUMPABLE, 0);
  // The child ends with its world, even if the world's process is killed.
  if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || ::getppid() == 1) ::_exit(kFailed);
  static Channel channel;
  if (!channel.open(net::Descriptor(kChannelFile))) ::_exit(kFailed);
  static RemoteWorld world(channel);
  // The engine reads files of the system while it starts, so the confinement follows.
  const std::unique_ptr<ProgramHost> programs = make_programs(world, mode == kRepeatable);
  if (!programs || !limit_child() || confine_programs()) ::_exit(kFailed);
  if (!channel.send({})) end_here();  // the world waits for this, because its limits of time begin later
  for (;;) world.report(programs->run(world.next_order()));
}

}  // namespace gs::app::script
