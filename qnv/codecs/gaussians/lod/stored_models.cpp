#include "qnv/codecs/gaussians/lod/stored_models.h"

#include <array>
#include <bit>
#include <type_traits>

namespace gs::qnv::gaussians {
namespace {

constexpr std::size_t kModelWords = sizeof(SplatModels) / sizeof(std::uint32_t), kMaskWords = (kModelWords + 31) / 32;
static_assert(sizeof(SplatModels) % sizeof(std::uint32_t) == 0);
static_assert(std::has_unique_object_representations_v<SplatModels>);
using ModelWords = std::array<std::uint32_t, kModelWords>;

const ModelWords& fresh_words(bool trained) {
  static const std::array<ModelWords, 2> words{std::bit_cast<ModelWords>(SplatModels()),
                                               std::bit_cast<ModelWords>(SplatModels(true))};
  return words[trained ? 1 : 0];
}

}  // namespace

StoredModels::StoredModels(const SplatModels& models) : trained_(models.trained != 0) {
  const ModelWords words = std::bit_cast<ModelWords>(models);
  const ModelWords& fresh = fresh_words(trained_);
  std::array<std::uint32_t, kMaskWords> masks{};
  words_ = kMaskWords;
  for (std::size_t i = 0; i < kModelWords; ++i) {
    const std::uint32_t changed = words[i] != fresh[i] ? 1 : 0;
    masks[i / 32] |= changed << i % 32;
    words_ += changed;
  }
  data_ = std::make_unique_for_overwrite<std::uint32_t[]>(words_);
  std::uint32_t* next = data_.get() + kMaskWords;
  for (std::size_t i = 0; i < kMaskWords; ++i) {
    data_[i] = masks[i];
    for (std::uint32_t left = masks[i]; left != 0; left &= left - 1)
      *next++ = words[32 * i + static_cast<std::size_t>(std::countr_zero(left))];
  }
}

void StoredModels::load(SplatModels& models) const {
  ModelWords words = fresh_words(trained_);
  const std::uint32_t* next = data_.get() + kMaskWords;
  for (std::size_t i = 0; i < kMaskWords; ++i)
    for (std::uint32_t left = data_[i]; left != 0; left &= left - 1)
      words[32 * i + static_cast<std::size_t>(std::countr_zero(left))] = *next++;
  models = std::bit_cast<SplatModels>(words);
}

}  // namespace gs::qnv::gaussians
