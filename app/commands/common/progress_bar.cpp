#include "app/commands/common/progress_bar.h"

#include "app/base/console.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <string>

namespace gs::app {
namespace {

volatile std::sig_atomic_t interrupted = 0;

extern "C" void interrupt(int) { interrupted = 1; }

}  // namespace

ProgressBar::ProgressBar(bool lines) {
  interrupted = 0;
  struct sigaction action {};
  action.sa_handler = interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  thread_ = std::jthread([this, lines](const std::stop_token& stop) {
    constexpr int kWidth = 30;
    constexpr std::chrono::seconds kBetween(5);
    const bool shows = progress_shows();
    auto next = std::chrono::steady_clock::now() + kBetween;
    while (!stop.stop_requested()) {
      if (interrupted != 0) whole_.cancelled = part_.cancelled = true;
      if (shows) show_progress(text(kWidth));
      if (!shows && lines && std::chrono::steady_clock::now() >= next) {
        complain("ghostspace: %s", text(0).c_str());
        next += kBetween;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(shows ? 50 : 10));
    }
    show_progress({});
  });
}

ProgressBar::~ProgressBar() { hide(); }

void ProgressBar::hide() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
  std::signal(SIGINT, SIG_DFL);
}

// Returns the stage and percent, with a bar of `width` characters between them.
std::string ProgressBar::text(int width) const {
  const Progress& counted = whole_.total > 0 || part_.done >= part_.total ? whole_ : part_;
  const std::uint64_t total = counted.total, done = std::min(counted.done.load(), total);
  const int percent = total > 0 ? static_cast<int>(done * 100 / total) : 0, filled = percent * width / 100;
  std::string text = whole_.cancelled ? "stopping" : whole_.stage.load();
  if (width == 0) return total > 0 ? text + " " + std::to_string(percent) + " %" : text;
  text.resize(std::max<std::size_t>(text.size(), 10), ' ');
  if (total > 0)
    text += " [" + std::string(static_cast<std::size_t>(filled), '#') +
            std::string(static_cast<std::size_t>(width - filled), ' ') + "] " + std::to_string(percent) + " %";
  return text;
}

}  // namespace gs::app
