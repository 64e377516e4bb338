#include "app/script/process/program_process.h"

#include "app/base/child_process.h"
#include "app/base/world_work.h"
#include "app/script/boundary/hear.h"
#include "app/script/process/program_child.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <utility>

#include <sys/wait.h>

namespace gs::app::script {
namespace {

// Time that a child has beyond the limit of its calls, before it is killed.
constexpr std::chrono::milliseconds kGrace{2000};
constexpr std::chrono::milliseconds kStartTime{10'000};  // for the start of a child
constexpr std::chrono::milliseconds kBetweenChecks{10};
constexpr char kImpossible[] = "the process for programs sent impossible data";
constexpr std::size_t kMessageRoom = std::size_t{64} << 20;  // bytes of a message beyond the heap of programs

std::string& program_of_scripts() {
  static std::string program;
  return program;
}

}  // namespace

void set_program_of_scripts(std::string program) { program_of_scripts() = std::move(program); }

ProgramProcess::ProgramProcess(WorldAccess& world, const std::string& program, bool repeatable) : world_(world) {
  channel_.set_patience([this] { return goes_on(); });
  const net::Descriptor memory = channel_.create();
  const std::array given{memory.get()};
  if (memory) child_ = start_child(program, {std::string(kProgramsArgument), repeatable ? kRepeatable : kLive}, given);
  if (child_ <= 0) stopped_ = "the process for programs cannot be started";
}

ProgramProcess::~ProgramProcess() { (void)end_child(child_); }

bool ProgramProcess::goes_on() {
  looked_ = Clock::now();
  siginfo_t ended{};
  if (::waitid(P_PID, static_cast<id_t>(child_), &ended, WEXITED | WNOHANG | WNOWAIT) != 0 || ended.si_pid != 0) {
    stop("");
    return false;
  }
  if (looked_ >= deadline_) {
    stop(kLateProgram);
    return false;
  }
  if (!is_wait_unwanted(began_)) return true;
  stop("the user has stopped the programs");
  return false;
}

void ProgramProcess::stop(const std::string& why) {
  const std::string reason = end_child(std::exchange(child_, 0));
  stopped_ = !why.empty() ? why : "the process for programs ended" + (reason.empty() ? "" : " by " + reason);
}

bool ProgramProcess::is_ready() {
  began_ = looked_ = Clock::now();
  deadline_ = began_ + kStartTime;
  unreported_ = 0;
  if (child_ <= 0) return false;
  if (!ready_ && !(ready_ = channel_.receive(message_, 0)) && child_ > 0) stop(kImpossible);
  return ready_;
}

Report ProgramProcess::run(const Order& order) {
  Report report;
  run_all({&order, 1}, [&](const Report& one) {
    report = one;
    return true;
  });
  return child_ > 0 ? report : Report{};
}

void ProgramProcess::run_all(std::span<const Order> orders, const Reported& reported) {
  if (!is_ready()) return;
  bool goes_on = true;
  const Reported note = [&](const Report& report) {
    goes_on = reported(report) && goes_on;
    return true;
  };
  while (goes_on && !orders.empty()) {
    bool skipped = false;
    std::size_t run = 0;
    const std::size_t sent = send_orders(orders, [&](const Report& report) {
      // The first order always runs, and none runs after one that was skipped.
      if (report.skipped ? run == 0 : skipped) return false;
      skipped = report.skipped;
      if (skipped) return true;
      ++run;
      return note(report);
    });
    if (sent == 0 || skipped) return;
    orders = orders.subspan(sent);
  }
}

std::size_t ProgramProcess::send_orders(std::span<const Order> orders, const Reported& reported) {
  constexpr std::size_t kFullMessage = Lane::kBytes / 2;
  const double seconds = orders.front().seconds;
  began_ = looked_ = Clock::now();
  deadline_ = began_ + kGrace + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  most_bytes_ = orders.front().heap + kMessageRoom;
  writer_.clear();
  channel_.set_progress(0);
  std::size_t sent = 0, came = 0;
  while (sent < orders.size() && (sent == 0 || writer_.bytes().size() < kFullMessage)) write(writer_, orders[sent++]);
  const bool good = hear_reports(sent, [&](const Report& report) { return ++came <= sent && reported(report); });
  if (good) return sent;
  const std::size_t begun = std::min<std::size_t>(channel_.progress(), sent);
  unreported_ = begun > came ? begun - came - 1 : 0;
  if (child_ > 0) stop(kImpossible);
  return 0;
}

bool ProgramProcess::hear_reports(std::size_t reports, const Reported& reported) {
  const Reported count = [&](const Report& report) {
    if (reports == 0) return false;
    --reports;
    return reported(report);
  };
  for (bool asked = true; asked || reports > 0;) {
    if (asked && !channel_.send(writer_.bytes())) return false;
    // A child that talks without end never lets this process wait.
    if (Clock::now() - looked_ >= kBetweenChecks && !goes_on()) return false;
    if (!channel_.receive(message_, most_bytes_)) return false;
    const Heard heard = hear(world_, message_, writer_, count);
    if (heard == Heard::impossible) return false;
    asked = heard == Heard::question;
    if (asked && reports == 0) return false;
  }
  return true;
}

std::unique_ptr<ProgramHost> make_confined_programs(WorldAccess& world, bool repeatable) {
  if (program_of_scripts().empty()) return make_programs(world, repeatable);
  return std::make_unique<ProgramProcess>(world, program_of_scripts(), repeatable);
}

}  // namespace gs::app::script
