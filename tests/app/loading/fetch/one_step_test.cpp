#include "app/loading/world_loader.h"
#include "qnv/codecs/shared/volume_series.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/volume_values.h"
#include "tests/app/worlds.h"
#include "tests/net/memory_network.h"
#include "tests/qnv/value_streams.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace gs::app {
namespace one_step_test {

constexpr std::uint32_t kEdge = 40, kSteps = 20;

// Ball that moves through noise.
qnv::VolumeSource moving_noise() {
  std::vector<qnv::VolumeSource> steps;
  for (std::uint32_t step = 0; step < kSteps; ++step) {
    qnv::VolumeSource one;
    one.layout.dimensions = {kEdge, kEdge, kEdge};
    one.layout.type = qnv::VoxelType::u16;
    one.read = [step](std::uint32_t z, std::span<std::byte> to) {
      std::uint32_t state = step * 977 + z * 131 + 1;
      for (std::uint32_t i = 0; i < kEdge * kEdge; ++i) {
        const double x = i % kEdge - 10.0 - step, y = i / kEdge - 20.0, w = z - 20.0;
        state = state * 1664525 + 1013904223;
        const auto value =
            static_cast<std::uint16_t>(3000 / (1 + std::exp(std::sqrt(x * x + y * y + w * w) - 8)) + (state >> 23));
        std::memcpy(to.data() + 2 * i, &value, 2);
      }
      return true;
    };
    steps.push_back(std::move(one));
  }
  qnv::VolumeSource source = steps.front();
  source.steps = steps;
  for (std::uint32_t step = 0; step < kSteps; ++step) source.times.push_back(step);
  return source;
}

const std::vector<std::byte>& noise_stream() {
  static const std::vector<std::byte> bytes = [] {
    qnv::EncodeOptions options;
    options.tolerance.lossless = true;
    return test::encoded_stream(qnv::encode_values(moving_noise(), options)).bytes;
  }();
  return bytes;
}

const qnv::Volume& volume_in(const LoadedWorld& world) {
  REQUIRE(world.geometries.size() == 1);
  const auto* const volume = world.geometries.begin()->second->as<qnv::Volume>();
  REQUIRE(volume);
  return *volume;
}

net::MemoryResource noise_resource() {
  net::MemoryResource resource;
  resource.bytes = noise_stream();
  resource.validator.etag = "\"1\"";
  return resource;
}

TEST_CASE("one step of a time series on a server is read without the others") {
  const std::vector<std::byte>& stream = noise_stream();
  REQUIRE(stream.size() > std::size_t{1} << 20);
  for (const std::uint32_t step : {0u, 10u, 19u}) {
    INFO(step);
    const auto network = std::make_shared<net::MemoryNetwork>();
    network->put("memory://a/noise.qnv", noise_resource());
    LoadOptions options;
    options.memory = net::MakeMemoryTransport{network};
    options.timeout_seconds = 60;
    options.one_step = true;
    options.component.step = qnv::ShownStep{step, {}};
    const LoadedWorld world = load_world("memory://a/noise.qnv", options);
    CHECK(world.diagnostics.entries().empty());
    std::uint64_t asked = 0;
    for (const net::TransferRequest& transfer : network->transfers()) {
      REQUIRE(transfer.range);
      asked += std::min<std::uint64_t>(transfer.range->end, stream.size()) - transfer.range->begin;
    }
    // The steps of the chain, the first bytes and the directory.
    const std::size_t needed = step % 8 + 1;
    CHECK(asked < stream.size() * needed / kSteps + stream.size() / 5);
    const qnv::Volume& volume = volume_in(world);
    REQUIRE(volume.values);
    CHECK(volume.values->step == step);
    CHECK(volume.values->exact);
    CHECK(test::values_in(volume.values->source) == test::values_in(moving_noise().steps[step]));
  }
}

TEST_CASE("all steps of a time series are read if views may show them") {
  const auto network = std::make_shared<net::MemoryNetwork>();
  network->put("memory://a/noise.qnv", noise_resource());
  LoadOptions options;
  options.memory = net::MakeMemoryTransport{network};
  const LoadedWorld world = load_world("memory://a/noise.qnv", options);
  const qnv::Volume& volume = volume_in(world);
  REQUIRE(volume.series);
  const qnv::Geometry last = volume.series->step({0, false, false, {kSteps - 1, {}}});
  REQUIRE(last.as<qnv::Volume>()->values);
  CHECK(last.as<qnv::Volume>()->values->exact);
}

}  // namespace one_step_test
}  // namespace gs::app
