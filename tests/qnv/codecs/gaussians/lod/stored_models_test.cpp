#include "qnv/codecs/gaussians/lod/stored_models.h"

#include "qnv/codecs/gaussians/splat_cluster.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <vector>

namespace gs::qnv::stored_models_test {
namespace {

using gaussians::SplatModels;
using gaussians::StoredModels;

/// Returns models after decoding `bytes` random bytes.
std::unique_ptr<SplatModels> used_models(std::size_t bytes, bool trained) {
  auto models = std::make_unique<SplatModels>(trained);
  std::mt19937 random(3);
  std::vector<std::byte> data(bytes);
  for (std::byte& one : data) one = static_cast<std::byte>(random());
  gaussians::Precision precision;
  precision.box.add({0, 0, 0});
  precision.box.add({1, 1, 1});
  const std::vector<gaussians::SplatNode> parents(20, gaussians::root_node(precision.box));
  std::vector<gaussians::SplatNode> nodes;
  (void)decode_nodes(data, parents, true, *models, precision, nodes);
  return models;
}

}  // namespace

TEST_CASE("models of Gaussians are stored without loss and in little memory") {
  for (const bool trained : {false, true}) {
    for (const std::size_t bytes : {0u, 100u, 1000u}) {
      const auto models = used_models(bytes, trained), loaded = used_models(500, !trained);
      const StoredModels stored(*models);
      CHECK(stored.bytes() < sizeof(SplatModels) / 2);
      stored.load(*loaded);
      const auto a = std::as_bytes(std::span(models.get(), 1)), b = std::as_bytes(std::span(loaded.get(), 1));
      CHECK(std::equal(a.begin(), a.end(), b.begin(), b.end()));
    }
    CHECK(StoredModels(SplatModels(trained)).bytes() < 1200);
  }
}

}  // namespace gs::qnv::stored_models_test
