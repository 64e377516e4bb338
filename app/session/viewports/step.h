#pragma once

#include "app/view/viewports.h"
#include "app/window/window_event.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Input and result of one step of a session.
namespace gs::app {

struct View;

/// Input of one step of a session.
struct SessionInput {
  struct Event {
    WindowEvent event;
    bool over_interface = false;  // the pointer is over a panel, which has precedence
  };
  std::vector<Event> events;
  /// Area that the viewports share, in framebuffer pixels; nullopt if the window is minimised.
  std::optional<Viewport> area;
  /// False if no picture is drawn after this step; then render lists need no update.
  bool look = true;
};

/// Message for the user.
struct Notice {
  std::string text;
  bool is_problem = false;
  /// Topic. A newer notice with the same topic replaces this one; if its text is empty, this one is only removed. An
  /// empty topic means no topic.
  std::string_view about{};
};

/// Result of one step of a session.
struct Frame {
  /// Picture of one visible viewport. `view` is null if the viewport is empty. Valid until the next step.
  struct Picture {
    std::size_t pane = 0;
    Viewport place;
    const View* view = nullptr;
  };
  std::vector<Picture> pictures;
  bool changed = false;  // a picture must be drawn again
  bool news = false;  // the list of files, progress or messages changed
  bool moving = false;  // a motion continues in the next step
  bool loading = false;  // data for a visible viewport are still loading
  std::optional<double> next_life;  // time of the next event in the worlds, seconds since 1970; nullopt means none
  bool files_chosen = false;  // the user chose other files, so older messages are obsolete
  std::vector<std::string> arrived;  // files that became visible or received more content
  struct Failure {
    std::string path, reason;
  };
  std::vector<Failure> failed;  // files that could not be opened, with reasons
  std::vector<Notice> notices;
  std::vector<std::string> web_pages;  // URLs to open in a web browser
  bool show_log = false;
};

/// Clock and result of the current step. All parts of a session share it.
struct StepContext {
  bool simulated = false;  // time and results depend only on the input; see SessionOptions::simulated
  double now = 0;  // time of the step, in seconds since 1970
  Frame frame{};           // result of the step

  /// Adds a message for the user to the result.
  void notify(std::string text, bool is_problem, std::string_view about = {}) {
    frame.notices.push_back({std::move(text), is_problem, about});
  }
};

}  // namespace gs::app
