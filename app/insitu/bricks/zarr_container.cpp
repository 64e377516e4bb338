#include "app/insitu/bricks/zarr_container.h"

#include "base/json_value.h"

#include <zstd.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace gs::app::insitu {
namespace {

constexpr std::string_view kContainerEnd = ".zarr/", kMetadataName = "zarr.json";
constexpr int kZstdLevel = 1;

std::optional<std::uint32_t> whole_number(std::string_view text) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

// Lists have the order z, y, x, as the dimensions of the arrays.
template <class Values>
JsonValue slow_first(const Values& values) {
  return JsonValue::list({values[2], values[1], values[0]});
}

JsonValue step_named(const char* name, JsonValue configuration) {
  return JsonValue::named({{"name", name}, {"configuration", std::move(configuration)}});
}

JsonValue level_json(const Pyramid& pyramid, const ZarrGrid& grid, std::uint32_t level) {
  JsonValue attributes = JsonValue::named({});
  if (!grid.unit.empty()) attributes.put("units", grid.unit);
  const bool coded = grid.codes.quantum > 0;
  JsonValue codecs = JsonValue::list();
  if (coded) {
    // Attributes of the CF conventions.
    attributes.put("scale_factor", static_cast<double>(grid.codes.quantum));
    attributes.put("add_offset", static_cast<double>(grid.codes.offset));
    attributes.put("_FillValue", std::int64_t{kMissingCode});
    codecs.add(step_named("numcodecs.delta", JsonValue::named({{"dtype", "<i2"}, {"astype", "<i2"}})));
  }
  codecs.add(step_named("bytes", JsonValue::named({{"endian", "little"}})));
  codecs.add(step_named("numcodecs.shuffle",
                        JsonValue::named({{"elementsize", coded ? sizeof(std::int16_t) : sizeof(float)}})));
  codecs.add(step_named("zstd", JsonValue::named({{"level", kZstdLevel}, {"checksum", false}})));
  return JsonValue::named(
      {{"zarr_format", 3},
       {"node_type", "array"},
       {"shape", slow_first(pyramid.size(level))},
       {"data_type", coded ? "int16" : "float32"},
       {"chunk_grid",
        step_named("regular", JsonValue::named({{"chunk_shape", slow_first(pyramid.chunk_shape(level))}}))},
       {"chunk_key_encoding", step_named("default", JsonValue::named({{"separator", "."}}))},
       {"fill_value", coded ? JsonValue(std::int64_t{kMissingCode}) : JsonValue("NaN")},
       {"codecs", std::move(codecs)},
       {"dimension_names", JsonValue::list({"z", "y", "x"})},
       {"attributes", std::move(attributes)}});
}

}  // namespace

std::optional<ZarrName> parse_zarr_name(std::string_view path) {
  const std::size_t end = path.find(kContainerEnd);
  if (end == std::string_view::npos) return std::nullopt;
  ZarrName name;
  name.container = path.substr(0, end + kContainerEnd.size() - 1);
  std::string_view rest = path.substr(end + kContainerEnd.size());
  if (rest == kMetadataName) return name;
  const std::size_t slash = rest.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  name.level = whole_number(rest.substr(0, slash));
  rest.remove_prefix(slash + 1);
  if (!name.level) return std::nullopt;
  if (rest == kMetadataName) return name;
  if (!rest.starts_with("c.")) return std::nullopt;
  Chunk chunk{*name.level, {}};
  rest.remove_prefix(2);
  for (std::size_t a = 3; a-- > 0;) {
    const std::size_t dot = a > 0 ? rest.find('.') : rest.size();
    const auto number = dot == std::string_view::npos ? std::nullopt : whole_number(rest.substr(0, dot));
    if (!number) return std::nullopt;
    chunk.index[a] = *number;
    rest.remove_prefix(a > 0 ? dot + 1 : dot);
  }
  name.chunk = chunk;
  return name;
}

std::string zarr_group(const Pyramid& pyramid, const ZarrGrid& grid) {
  JsonValue levels = JsonValue::named({}), datasets = JsonValue::list();
  for (std::uint32_t level = 0; level < pyramid.levels(); ++level) {
    std::array<double, 3> spacing = grid.spacing;
    for (double& one : spacing) one *= static_cast<double>(std::uint64_t{1} << level);
    levels.put(std::to_string(level), level_json(pyramid, grid, level));
    datasets.add(JsonValue::named(
        {{"path", std::to_string(level)},
         {"coordinateTransformations",
          JsonValue::list({JsonValue::named({{"type", "scale"}, {"scale", slow_first(spacing)}}),
                           JsonValue::named({{"type", "translation"}, {"translation", slow_first(grid.origin)}})})}}));
  }
  JsonValue axes = JsonValue::list();
  for (const char* axis : {"z", "y", "x"}) axes.add(JsonValue::named({{"name", axis}, {"type", "space"}}));
  JsonValue image =
      JsonValue::named({{"name", grid.field}, {"axes", std::move(axes)}, {"datasets", std::move(datasets)}});
  return JsonValue::named(
             {{"zarr_format", 3},
              {"node_type", "group"},
              {"attributes",
               JsonValue::named({{"ome", JsonValue::named({{"version", "0.5"},
                                                           {"multiscales", JsonValue::list({std::move(image)})}})}})},
              {"consolidated_metadata",
               JsonValue::named({{"kind", "inline"}, {"must_understand", false}, {"metadata", std::move(levels)}})}})
      .json();
}

std::string zarr_level(const Pyramid& pyramid, const ZarrGrid& grid, std::uint32_t level) {
  return level_json(pyramid, grid, level).json();
}

struct ChunkEncoder::Context {
  ~Context() { (void)ZSTD_freeCCtx(compressor); }
  ZSTD_CCtx* compressor = ZSTD_createCCtx();
};

ChunkEncoder::ChunkEncoder() : context_(std::make_unique<Context>()) {
  if (!context_->compressor) throw std::bad_alloc();
}

ChunkEncoder::~ChunkEncoder() = default;

std::string ChunkEncoder::encode(const GridIndex& shape, const ReadLayers& read, const ZarrGrid& grid) {
  const std::size_t layer = std::size_t{shape[0]} * shape[1], points = layer * shape[2];
  if (grid.codes.quantum > 0) {
    constexpr std::uint32_t kLayers = 4;
    shuffled_.resize(points * sizeof(std::int16_t));
    codes_.resize(layer * kLayers);
    values_.resize(layer * kLayers);
    std::int16_t previous = 0;
    for (std::uint32_t z = 0; z < shape[2]; z += kLayers) {
      const std::size_t count = layer * std::min(kLayers, shape[2] - z);
      read(z, std::span(values_).first(count));
      FiniteRange range;
      quantise(values_.data(), count, grid.codes, codes_.data(), range);
      std::uint8_t* const low = shuffled_.data() + layer * z;
      shuffle_differences(codes_.data(), count, previous, low, low + points);
      previous = codes_[count - 1];
    }
  } else {
    values_.resize(points);
    shuffled_.resize(points * sizeof(float));
    read(0, values_);
    round_within(values_.data(), points, grid.rounding);
    shuffle_floats(values_.data(), points, shuffled_.data());
  }
  packed_.resize(std::max(packed_.size(), ZSTD_compressBound(shuffled_.size())));
  const std::size_t size = ZSTD_compressCCtx(context_->compressor, packed_.data(), packed_.size(), shuffled_.data(),
                                             shuffled_.size(), kZstdLevel);
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // the only error if the buffer is large enough
  return packed_.substr(0, size);
}

}  // namespace gs::app::insitu
