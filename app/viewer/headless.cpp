#include "app/viewer/headless.h"

#include "app/base/console.h"
#include "app/session/documents/living_world.h"
#include "app/viewer/offscreen.h"

#include <semaphore.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <ctime>
#include <memory>
#include <optional>
#include <utility>

namespace gs::app {
namespace {

constexpr double kNobodyWait = 30;        // seconds; whoever wants something ends it
constexpr double kMovingWait = 1.0 / 60;  // while the viewer moves
constexpr double kReadingWait = 0.25;     // while a world is read

/// Wakes who waits; from other threads, and from signals.
class Doorbell {
 public:
  Doorbell() { (void)sem_init(&semaphore_, 0, 0); }
  ~Doorbell() { (void)sem_destroy(&semaphore_); }
  Doorbell(const Doorbell&) = delete;
  Doorbell& operator=(const Doorbell&) = delete;

  void ring() { (void)sem_post(&semaphore_); }
  void wait(double seconds) {
    timespec until{};
    (void)clock_gettime(CLOCK_MONOTONIC, &until);
    const double end = static_cast<double>(until.tv_nsec) * 1e-9 + std::max(0.0, seconds);
    until.tv_sec += static_cast<time_t>(end);
    until.tv_nsec = static_cast<long>((end - std::floor(end)) * 1e9);
    (void)sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &until);
    while (sem_trywait(&semaphore_) == 0) {
    }
  }

 private:
  sem_t semaphore_{};
};

volatile std::sig_atomic_t told_to_end = 0;
std::atomic<Doorbell*> signal_bell = nullptr;
static_assert(std::atomic<Doorbell*>::is_always_lock_free);

extern "C" void end_on_signal(int) {
  told_to_end = 1;
  if (Doorbell* const bell = signal_bell.load()) bell->ring();
}

/// While it is there, SIGINT and SIGTERM ring.
class EndOnSignals {
 public:
  explicit EndOnSignals(Doorbell& bell) {
    told_to_end = 0;
    signal_bell = &bell;
    struct sigaction action {};
    action.sa_handler = end_on_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second one ends it at once, as it would any program
    (void)sigaction(SIGINT, &action, &before_[0]);
    (void)sigaction(SIGTERM, &action, &before_[1]);
  }
  ~EndOnSignals() {
    (void)sigaction(SIGINT, &before_[0], nullptr);
    (void)sigaction(SIGTERM, &before_[1], nullptr);
    signal_bell = nullptr;
  }
  EndOnSignals(const EndOnSignals&) = delete;
  EndOnSignals& operator=(const EndOnSignals&) = delete;

 private:
  struct sigaction before_[2]{};
};

// Prints what is told of worlds, each thing once.
void tell(Session& session, const Frame& frame) {
  for (const Notice& notice : frame.notices) complain("ghostspace: %s", notice.text.c_str());
  for (const std::string& line : session.log().take_untold()) complain("%s", line.c_str());
}

bool is_anything_there(const Session& session) {
  const Panes& panes = session.panes();
  for (const std::size_t i : panes.visible())
    if (panes.at(i).view() || panes.loading(i)) return true;
  return false;
}

}  // namespace

int run_headless(const ViewerOptions& options, const LoadOptions& load, const std::string& backend,
                 std::string& error) {
  Doorbell bell;
  const EndOnSignals signals(bell);
  const auto wake = [&bell] { bell.ring(); };
  std::optional<OpenedRenderer> opened;
  Session session(session_options(options), load, wake);
  auto started = ControlService::start(options.control, wake);
  if (auto* problem = std::get_if<std::string>(&started)) {
    error = "cannot be controlled: " + *problem;
    return 1;
  }
  const auto service = std::move(std::get<std::unique_ptr<ControlService>>(started));
  Control& control = service->control();
  // Not before somebody wants to see something: who streams events needs no driver.
  control.set_painter(
      [&](const View& view, int width, int height) -> std::variant<std::vector<std::byte>, std::string> {
        if (!opened) {
          opened.emplace(open_renderer(backend, {}));
          if (opened->context) opened->context->make_current();
        }
        if (!opened->renderer) return opened->problem;
        return paint(*opened->renderer, options, view, {width, height});
      });
  session.add_guest(control);
  SessionInput input;
  input.area = Viewport{0, 0, options.width, options.height};
  while (!told_to_end && !control.wants_to_end()) {
    const Frame frame = session.step(world_time(), input);
    session.ask_for_streams();
    tell(session, frame);
    if (!is_anything_there(session)) {
      error = "there is no world to be controlled";
      break;
    }
    double wait = frame.loading ? kReadingWait : kNobodyWait;
    if (frame.moving) wait = std::min(wait, kMovingWait);
    if (frame.next_life) wait = std::min(wait, *frame.next_life - world_time());
    if (!control.wants_to_end()) bell.wait(wait);
  }
  session.remove_guest(control);
  return error.empty() ? 0 : 1;
}

}  // namespace gs::app
