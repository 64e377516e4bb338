#pragma once

#include "qnv/codecs/gaussians/splat_models.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace gs::qnv::gaussians {

/// Compact copy of models. A cluster uses few models, so the copy has only the words that differ from fresh models.
class StoredModels {
 public:
  explicit StoredModels(const SplatModels& models);
  void load(SplatModels& models) const;
  [[nodiscard]] std::size_t bytes() const { return words_ * sizeof(std::uint32_t); }

 private:
  bool trained_;
  std::size_t words_ = 0;
  std::unique_ptr<std::uint32_t[]> data_;  // one bit per word of the models, 1 if changed; then the changed words
};

}  // namespace gs::qnv::gaussians
