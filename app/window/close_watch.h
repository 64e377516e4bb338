#pragma once

namespace gs::app {

/// Detector of requests to close the window (close button or Ctrl+Q) that still wait in the X server's event queue. Any
/// thread may ask while the main thread is busy. Detects nothing on other window systems.
class CloseWatch {
 public:
  /// Call on the main thread while the window exists.
  CloseWatch();

  [[nodiscard]] bool is_asked_to_close() const;

 private:
  void* display_ = nullptr;
  void* check_ = nullptr;  // XCheckIfEvent
  unsigned long protocols_ = 0, delete_window_ = 0;
  unsigned quit_key_ = 0;
};

}  // namespace gs::app
