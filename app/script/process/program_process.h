#pragma once

#include "app/script/boundary/message.h"
#include "app/script/process/channel.h"

#include <chrono>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <sys/types.h>

namespace gs::app::script {

/// Makes make_confined_programs() use this program for its children. Call it at the start of main(). With an empty
/// path, programs run in this process, as in tests and in processes that are confined themselves.
void set_program_of_scripts(std::string program);

/// Host that runs programs in a confined child process. The child is killed if it does not answer in time, if it
/// crashes, if it says anything impossible, or if the user wants the wait to end (app/base/world_work.h).
class ProgramProcess final : public ProgramHost {
 public:
  ProgramProcess(WorldAccess& world, const std::string& program, bool repeatable);
  ~ProgramProcess() override;

  [[nodiscard]] Report run(const Order& order) override;
  void run_all(std::span<const Order> orders, const Reported& reported) override;
  [[nodiscard]] std::size_t unreported() const override { return unreported_; }
  [[nodiscard]] std::string stopped() const override { return stopped_; }
  [[nodiscard]] pid_t process() const { return child_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// Waits for the start of the child. Returns false if it failed.
  [[nodiscard]] bool is_ready();
  /// Sends the first orders, as many as fit into a message, and answers questions until all have reports. Returns their
  /// number; 0 if the child failed.
  [[nodiscard]] std::size_t send_orders(std::span<const Order> orders, const Reported& reported);
  /// Sends the message in `writer_` and answers questions until `reports` reports came. Returns false if the child
  /// failed.
  [[nodiscard]] bool hear_reports(std::size_t reports, const Reported& reported);
  [[nodiscard]] bool goes_on();
  void stop(const std::string& why);

  WorldAccess& world_;
  pid_t child_ = 0;
  Channel channel_;
  MessageWriter writer_;
  std::vector<std::byte> message_;
  bool ready_ = false;          // the child has started
  std::size_t most_bytes_ = 0;  // of a message
  std::size_t unreported_ = 0;
  Clock::time_point began_, looked_, deadline_;
  std::string stopped_;
};

/// Makes a host that runs programs in a confined child process, or in this process (set_program_of_scripts()). Returns
/// null if memory is insufficient.
[[nodiscard]] std::unique_ptr<ProgramHost> make_confined_programs(WorldAccess& world, bool repeatable);

}  // namespace gs::app::script
