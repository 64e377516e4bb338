#pragma once

#include "app/insitu/include/ghostspace/insitu.h"
#include "qnv/reader/decode_stream.h"
#include "tests/app/scratch_folder.h"
#include "tests/qnv/value_streams.h"

#include <catch2/catch.hpp>

#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace gs::app::insitu::test {

struct CloseSession {
  void operator()(gs_insitu* session) const { gs_insitu_close(session); }
};
using Session = std::unique_ptr<gs_insitu, CloseSession>;

inline gs_insitu_options plain_options() {
  gs_insitu_options options;
  gs_insitu_options_init(&options, sizeof options);
  options.max_share = 0;  // the results must not depend on the speed of the machine
  return options;
}

/// Opens a session, which must succeed.
inline Session opened(const gs_insitu_options& options, const gs_insitu_communicator* communicator = nullptr) {
  char error[256] = "";
  Session session(gs_insitu_open(&options, communicator, error, sizeof error));
  INFO(error);
  REQUIRE(session);
  return session;
}

inline std::vector<std::byte> bytes_of_text(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

/// Decoded volume of a stream.
struct DecodedVolume {
  std::array<std::uint32_t, 3> size{};
  std::vector<float> values;
  qnv::VolumeLayout layout;
  qnv::VoxelType stored{};
  double error = 0;
};
inline DecodedVolume decoded_volume(const std::string& stream) {
  const std::vector<std::byte> bytes = bytes_of_text(stream);
  const gs::test::ShownValues shown(bytes);
  REQUIRE(shown.values);
  REQUIRE(shown.values->level == 0);
  REQUIRE(shown.values->error);
  return {shown.values->source.layout.dimensions, gs::test::values_in(shown.values->source),
          shown.values->source.layout, shown.values->stored, static_cast<double>(*shown.values->error)};
}

/// Cubic grid with a smooth field, for blocks.
struct SmoothGrid {
  explicit SmoothGrid(std::int64_t edge) : n(edge) {}

  [[nodiscard]] double at(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const auto part = [this](std::int64_t i) { return static_cast<double>(i) / static_cast<double>(n); };
    return 10 * part(x) + 5 * part(y) * part(y) - 3 * part(z);
  }
  /// Returns a block with the layers [first, end), and puts the values of its points into `values`.
  [[nodiscard]] gs_insitu_block block(std::int64_t first, std::int64_t end, std::vector<double>& values,
                                      gs_insitu_field& field, std::int64_t ghosts = 0) const {
    values.clear();
    for (std::int64_t z = first - ghosts; z < end + ghosts; ++z)
      for (std::int64_t y = 0; y < n; ++y)
        for (std::int64_t x = 0; x < n; ++x) values.push_back(z < first || z >= end ? 1e9 : at(x, y, z));
    field = {};
    field.name = "heat";
    field.unit = "K";
    field.data = values.data();
    field.type = GS_INSITU_FLOAT64;
    gs_insitu_block block{};
    block.size = sizeof block;
    block.whole_extent[1] = block.whole_extent[3] = block.whole_extent[5] = n - 1;
    block.extent[1] = block.extent[3] = n - 1;
    block.extent[4] = first - ghosts;
    block.extent[5] = end - 1 + ghosts;
    block.ghost[4] = block.ghost[5] = static_cast<std::int32_t>(ghosts);
    block.fields = &field;
    block.field_count = 1;
    return block;
  }
  std::int64_t n;
};

}  // namespace gs::app::insitu::test
