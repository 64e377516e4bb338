#pragma once

#include "qnv/codecs/gaussians/splat_models.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace gs::qnv::gaussians {

/// Copy of models in little memory. Most models of a cluster were never used, so only the others are stored.
class StoredModels {
 public:
  explicit StoredModels(const SplatModels& models);
  void load(SplatModels& models) const;
  [[nodiscard]] std::size_t bytes() const { return words_ * sizeof(std::uint32_t); }

 private:
  std::size_t words_ = 0;
  std::unique_ptr<std::uint32_t[]> data_;  // one bit per word of the models that was changed, then these words
};

}  // namespace gs::qnv::gaussians
