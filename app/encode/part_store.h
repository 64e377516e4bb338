#pragma once

#include "net/files/part_files.h"
#include "qnv/codecs/shared/spill_store.h"

#include <utility>

namespace gs::app {

/// Store for an encoder that shares its work with other processes: part files in a folder that all of them can read.
class PartStore final : public qnv::SpillStore {
 public:
  explicit PartStore(net::PartFiles files) : files_(std::move(files)) {}

  [[nodiscard]] bool append(std::span<const std::byte> bytes) override { return files_.append(bytes); }
  [[nodiscard]] std::uint64_t size() const override { return files_.size(); }
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::byte> to) const override {
    return files_.read(offset, to);
  }
  [[nodiscard]] std::string problem() const override { return files_.problem(); }
  [[nodiscard]] std::optional<std::vector<std::byte>> finished(std::string_view work) const override {
    return files_.finished(work);
  }
  [[nodiscard]] bool finish(std::string_view work, std::uint64_t first, std::span<const std::byte> result) override {
    return files_.finish(work, first, result);
  }

 private:
  net::PartFiles files_;
};

}  // namespace gs::app
