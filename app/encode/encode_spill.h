#pragma once

#include "net/files/temporary_file.h"
#include "qnv/codecs/shared/spill_store.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace gs::app {

/// Store of an encoder in memory. Beyond a size, it moves to a temporary file.
class EncodeSpill final : public qnv::SpillStore {
 public:
  /// Keeps at most `most_bytes` in memory. The file is in `folder`, or in the usual folder for temporary files if that
  /// is empty.
  EncodeSpill(std::size_t most_bytes, std::string folder) : most_bytes_(most_bytes), folder_(std::move(folder)) {}

  [[nodiscard]] bool append(std::span<const std::byte> bytes) override;
  [[nodiscard]] std::uint64_t size() const override { return file_ ? file_->size() : memory_.size(); }
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::byte> to) const override;
  [[nodiscard]] std::string problem() const override { return problem_; }

 private:
  bool move_to_file();

  std::size_t most_bytes_;
  std::string folder_, problem_ = "the temporary file cannot be read";
  qnv::MemoryStore memory_;
  std::optional<net::TemporaryFile> file_;
};

}  // namespace gs::app
