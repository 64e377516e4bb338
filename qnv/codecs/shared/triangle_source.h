#pragma once

#include "qnv/base/triangles.h"

#include <concepts>
#include <cstdint>
#include <functional>
#include <type_traits>
#include <utility>

namespace gs::qnv {

/// Reader of the triangles of a surface. Each call passes the same triangles in the same order. A large surface
/// consists of runs. Each run can be read alone, so that several processes can share them. One thread at a time.
class TriangleSource {
 public:
  using ReadRun = std::function<bool(std::uint64_t run, const TriangleSink&)>;

  TriangleSource() = default;
  /// Creates a source with one run. `read` returns false if reading failed or the sink returned false.
  template <class Read>
  requires(!std::same_as<std::remove_cvref_t<Read>, TriangleSource> &&
           std::is_invocable_r_v<bool, Read&, const TriangleSink&>) TriangleSource(Read read)
      : read_([read = std::move(read)](std::uint64_t, const TriangleSink& sink) mutable { return read(sink); }) {}
  TriangleSource(std::uint64_t runs, ReadRun read) : runs_(runs), read_(std::move(read)) {}

  [[nodiscard]] std::uint64_t runs() const { return runs_; }
  /// Passes the triangles of one run to a sink. Returns false if reading failed or the sink returned false.
  bool read(std::uint64_t run, const TriangleSink& sink) const { return read_(run, sink); }
  /// Passes all triangles to a sink. Returns false if reading failed or the sink returned false.
  bool operator()(const TriangleSink& sink) const {
    for (std::uint64_t run = 0; run < runs_; ++run)
      if (!read_(run, sink)) return false;
    return true;
  }

 private:
  std::uint64_t runs_ = 1;
  ReadRun read_;
};

}  // namespace gs::qnv
