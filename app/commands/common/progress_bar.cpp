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

ProgressBar::ProgressBar() {
  interrupted = 0;
  struct sigaction action {};
  action.sa_handler = interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  thread_ = std::jthread([this](const std::stop_token& stop) {
    const bool shows = progress_shows();
    while (!stop.stop_requested()) {
      if (interrupted != 0) whole_.cancelled = part_.cancelled = true;
      if (shows) draw();
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

void ProgressBar::draw() {
  constexpr int kWidth = 30;
  const Progress& counted = whole_.total > 0 || part_.done >= part_.total ? whole_ : part_;
  const std::uint64_t total = counted.total, done = std::min(counted.done.load(), total);
  const int percent = total > 0 ? static_cast<int>(done * 100 / total) : 0, filled = percent * kWidth / 100;
  std::string text = whole_.cancelled ? "stopping" : whole_.stage.load();
  text.resize(std::max<std::size_t>(text.size(), 10), ' ');
  if (total > 0)
    text += " [" + std::string(static_cast<std::size_t>(filled), '#') +
            std::string(static_cast<std::size_t>(kWidth - filled), ' ') + "] " + std::to_string(percent) + " %";
  show_progress(text);
}

}  // namespace gs::app
