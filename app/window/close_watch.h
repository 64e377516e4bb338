#pragma once

namespace gs::app {

/// Detector of requests to close the window, by the close button or Ctrl+Q. Any thread can check for requests that
/// still wait in the X server's queue, for example while the main thread is busy. On window systems other than X11, it
/// detects nothing.
class CloseWatch {
 public:
  /// Prepares the checks. Call on the main thread while the window exists.
  CloseWatch();

  /// Reports whether the user has asked to close the window (its button or Ctrl+Q), or has pressed Esc. The events stay
  /// in the queue.
  [[nodiscard]] bool is_asked_to_stop() const;

 private:
  void* display_ = nullptr;
  void* check_ = nullptr;  // address of XCheckIfEvent
  unsigned long protocols_ = 0, delete_window_ = 0;
  unsigned quit_key_ = 0, escape_key_ = 0;
};

}  // namespace gs::app
