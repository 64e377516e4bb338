#pragma once

#include "app/formats/datasets/arrays/array_file.h"

#include <hdf5.h>

#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Handle of HDF5 that closes itself.
class Hdf5Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  [[nodiscard]] hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// Holds the lock of HDF5 and silences its messages on this thread. Before the first use, forbids plugins and links to
/// other files.
class Hdf5Scope {
 public:
  Hdf5Scope();

 private:
  std::lock_guard<std::recursive_mutex> lock_;
};

/// Returns the innermost message of the last failure, or `otherwise`.
[[nodiscard]] std::string hdf5_problem(std::string otherwise);

/// Bytes of a file for the driver. One thread at a time.
struct Hdf5Source {
  ArrayBytes bytes;
  std::vector<ByteSpan>* looked_up = nullptr;  // if set, reads of values fail and append their byte ranges
};

/// Opens a file in memory, read only. `source` must outlive the handle and keep its address.
[[nodiscard]] Hdf5Handle open_hdf5_bytes(Hdf5Source& source);

}  // namespace gs::app
