#pragma once

#include "app/view/viewports.h"
#include "app/window/window_event.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Input and result of a step of a session.
namespace gs::app {

struct View;

/// Input of a step of a session.
struct SessionInput {
  struct Event {
    WindowEvent event;
    bool over_interface = false;  // the pointer is over a panel, which handles the event first
  };
  std::vector<Event> events;
  /// Area of all viewports, in framebuffer pixels. Nullopt if the window is minimised.
  std::optional<Viewport> area;
  /// False if no picture is needed yet; render lists then need no update.
  bool look = true;
};

/// Message to the user.
struct Notice {
  std::string text;
  bool is_problem = false;
  /// Topic. A newer notice with this topic replaces this one; one without text removes it. Empty means none.
  std::string_view about{};
};

/// Result of a step.
struct Frame {
  /// Visible viewport; `view` is null if it is empty. Valid until the next step.
  struct Picture {
    std::size_t pane = 0;
    Viewport place;
    const View* view = nullptr;
  };
  std::vector<Picture> pictures;
  bool changed = false;              // the picture has changed
  bool news = false;                 // files, progress or messages have changed
  bool moving = false;               // motion continues in the next step, whenever that is
  bool loading = false;              // something that the user waits for is still loading
  std::optional<double> next_life;   // time of the worlds' next event, seconds since 1970; nullopt means none
  bool files_chosen = false;         // the user chose other files; older messages are obsolete
  std::vector<std::string> arrived;  // files that became visible or have more content
  struct Failure {
    std::string path, reason;
  };
  std::vector<Failure> failed;  // files that could not be opened
  std::vector<Notice> notices;
  std::vector<std::string> web_pages;  // to open in a web browser
  bool show_log = false;
};

/// Clock and result of the running step, shared by the parts of a session.
struct StepContext {
  bool simulated = false;  // time and results depend on the input alone; see SessionOptions
  double now = 0;          // time of the step, seconds since 1970
  Frame frame{};           // result of the step

  /// Adds a message to the user to the result.
  void notify(std::string text, bool is_problem, std::string_view about = {}) {
    frame.notices.push_back({std::move(text), is_problem, about});
  }
};

}  // namespace gs::app
