#include "app/viewer/headless.h"

#include "app/base/console.h"
#include "app/desktop/end_signals.h"
#include "app/session/running/world_runtime.h"
#include "app/viewer/offscreen.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

namespace gs::app {
namespace {

constexpr double kNobodyWait = 30;        // seconds; max wait without events; a request ends it
constexpr double kMovingWait = 1.0 / 60;  // seconds; max wait while a viewer moves
constexpr double kReadingWait = 0.25;     // seconds; max wait while a world is read

// Prints the new notices and the new diagnostics of the worlds.
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
  const WorldStop stop([] { return EndOnSignals::told(); });
  const auto wake = [&bell] { bell.ring(); };
  std::optional<OpenedRenderer> opened;
  Session session(options.session, load, wake);
  auto started = ControlService::start(options.control, wake);
  if (auto* problem = std::get_if<std::string>(&started)) {
    error = "cannot be controlled: " + *problem;
    return 1;
  }
  const auto service = std::move(std::get<std::unique_ptr<ControlService>>(started));
  Control& control = service->control();
  // Open the renderer only when a client requests the first picture, because clients that only use events need no
  // graphics driver.
  control.set_painter(
      [&](const View& view, int width, int height) -> std::variant<std::vector<std::byte>, std::string> {
        if (!opened) {
          opened.emplace(open_renderer(backend, {}));
          if (opened->context) opened->context->make_current();
        }
        if (!opened->renderer) return opened->problem;
        return paint(*opened->renderer, options, view, *view.list, {width, height});
      });
  session.add_extension(control);
  SessionInput input;
  input.area = Viewport{0, 0, options.width, options.height};
  while (!EndOnSignals::told() && !control.wants_to_end()) {
    const Frame frame = session.step(world_time(), input);
    session.streams().request();
    tell(session, frame);
    if (!is_anything_there(session)) {
      error = "no world to control; expected a file";
      break;
    }
    double wait = frame.loading ? kReadingWait : kNobodyWait;
    if (frame.moving) wait = std::min(wait, kMovingWait);
    if (frame.next_life) wait = std::min(wait, *frame.next_life - world_time());
    if (!control.wants_to_end()) bell.wait(wait);
  }
  session.remove_extension(control);
  return error.empty() ? 0 : 1;
}

}  // namespace gs::app
