#pragma once

namespace gs::app {

/// Looks for requests to close the window among events that the main thread has not taken from the X server yet: the
/// window's close button and Ctrl+Q. Any thread may look while the main thread is busy with something else. Finds
/// nothing on other window systems.
class CloseWatch {
 public:
  /// Main thread, while the window exists.
  CloseWatch();

  [[nodiscard]] bool is_asked_to_close() const;

 private:
  void* display_ = nullptr;
  void* check_ = nullptr;  // XCheckIfEvent
  unsigned long protocols_ = 0, delete_window_ = 0;
  unsigned quit_key_ = 0;
};

}  // namespace gs::app
