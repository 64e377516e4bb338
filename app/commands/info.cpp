#include "app/base/console.h"
#include "app/commands/options/commands.h"
#include "app/commands/vectors_of.h"
#include "app/encode/surface_triangles.h"
#include "app/formats/content_types.h"
#include "app/formats/qnv/cloud_reader.h"
#include "net/base/url.h"
#include "net/files/file.h"
#include "qnv/codec/payloads.h"
#include "qnv/decode/decoder.h"
#include "qnv/displaced/surface.h"
#include "qnv/lod/lod.h"
#include "qnv/outline/outline_stream.h"
#include "qnv/volume/volume_slices.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

namespace gs::app {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

Json json_of(const glm::dvec3& p) { return {p.x, p.y, p.z}; }

void put_box(Json& json, const glm::dvec3& lower, const glm::dvec3& upper) {
  if (lower.x <= upper.x) json["box"] = {{"lower", json_of(lower)}, {"upper", json_of(upper)}};
}

void put_metadata(Json& json, const std::vector<std::pair<std::string, std::string>>& metadata) {
  Json all = Json::object();
  for (const auto& [key, value] : metadata) all[key] = value;
  if (!all.empty()) json["metadata"] = std::move(all);
}

void put_cloud(Json& json, const qnv::Cloud& cloud) {
  const qnv::Description& d = cloud.description;
  const bool volume = d.kind == qnv::Kind::volume;
  json["kind"] = volume ? "volume" : "surface";
  json["vectors"] = cloud.size();
  json[volume ? "magnitude" : "area"] = d.total;
  if (volume) {
    json["spacing"] = d.spacing;
    json["values"] = {d.value_range.first, d.value_range.second};
    json["transfer_points"] = d.transfer.size();
  } else {
    json["two_sided"] = d.two_sided;
    json["colors"] = cloud.colors.empty() ? "one" : "of each vector";
  }
  put_box(json, d.origin + glm::dvec3(d.box.lower), d.origin + glm::dvec3(d.box.upper));
  if (d.origin != glm::dvec3(0)) json["local_origin"] = json_of(d.origin);
}

// What has arrived of one level of the octree, or one layer.
struct Level {
  std::size_t chunks = 0, bytes = 0, vectors = 0;
};

// Chunks of a stream by level; vectors only of records, which say how many they are.
std::map<int, Level> levels_of(std::span<const std::byte> bytes) {
  std::map<int, Level> levels;
  qnv::StreamReader reader;
  (void)reader.push(bytes, [&](qnv::ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    int level = -1;
    std::size_t vectors = 0;
    if (type == qnv::ChunkType::packed) {
      const auto read = qnv::read_cluster_header(payload);
      if (const auto* header = std::get_if<qnv::ClusterHeader>(&read)) level = header->level + header->levels;
    } else if (type == qnv::ChunkType::displaced) {
      const auto header = qnv::displaced::decode_cluster_header(payload);
      if (header) level = header->kind == qnv::displaced::ClusterHeader::Kind::base ? 0 : header->level;
    } else if (type == qnv::ChunkType::piece) {
      level = 0;
    } else if (type == qnv::ChunkType::voxels) {
      const auto read = qnv::read_volume_cluster_header(payload);
      if (const auto* header = std::get_if<qnv::ClusterHeader>(&read)) level = header->level + header->levels;
    } else if (type == qnv::ChunkType::records && payload.size() >= qnv::kRecordsHeaderBytes) {
      level = std::to_integer<int>(payload.front());
      vectors = (payload.size() - qnv::kRecordsHeaderBytes) / qnv::kRecordBytes;
    }
    if (level < 0) return;
    Level& l = levels[level];
    ++l.chunks;
    l.bytes += qnv::kChunkHeaderBytes + payload.size();
    l.vectors += vectors;
  });
  return levels;
}

void put_levels(Json& json, const qnv::StreamHeader& header, const qnv::Cloud& cloud,
                std::span<const std::byte> bytes) {
  const bool voxels = header.payload == qnv::Payload::voxels, octree = voxels || header.payload == qnv::Payload::packed;
  const bool layers = header.payload == qnv::Payload::records;
  std::map<int, Level> levels = levels_of(bytes);
  const auto level_of = [&](const qnv::Cell& cell) {
    if (!voxels) return static_cast<int>(std::lround(std::log2(header.cube.edge / cell.edge)));
    int level = header.lattice.depth;
    while (level > 0 && header.lattice.reach(level) < cell.edge) --level;
    return level;
  };
  // Of an octree those are counted that no finer ones have replaced.
  if (octree)
    for (const qnv::Cell& cell : cloud.cells)
      if (voxels || cell.edge > 0) ++levels[level_of(cell)].vectors;
  Json list = Json::array();
  for (const auto& [level, l] : levels) {
    list.push_back({{layers ? "layer" : "level", level}, {"chunks", l.chunks}, {"bytes", l.bytes}});
    if (octree || layers) list.back()[octree ? "shown" : "vectors"] = l.vectors;
  }
  json["levels"] = std::move(list);
}

bool describe_outlines(Json& json, std::span<const std::byte> bytes, const std::string& path, const vrml::Budget&) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  qnv::OutlineDecoder decoder;
  for (auto rest = bytes; !rest.empty(); rest = rest.subspan(std::min(kPiece, rest.size()))) {
    if (!decoder.push(rest.first(std::min(kPiece, rest.size())))) break;
    (void)decoder.take();  // only counted
  }
  decoder.finish();
  const qnv::StreamHeader* header = decoder.header();
  Json problems = Json::array();
  for (const qnv::StreamProblem& problem : decoder.problems()) {
    problems.push_back("byte " + std::to_string(problem.offset) + ": " + problem.message);
    if (!header) complain("%s: error: %s", path.c_str(), problems.back().get<std::string>().c_str());
  }
  if (!header) return false;
  json["payload"] = "outlines";
  json["groups"] = header->outlines.groups;
  json["outline_polygons"] = decoder.outline_polygons();
  json["inner_polygons"] = decoder.inner_polygons();
  json["polygons_at_full_detail"] = header->vectors;
  json["appearances"] = header->outlines.appearances.size();
  json["step"] = header->outlines.positions.step();
  put_box(json, header->description.box.lower, header->description.box.upper);
  json["chunks"] = header->chunks;
  json["directory_entries"] = decoder.directory().size();
  json["damaged_chunks"] = decoder.refused_chunks();
  json["damaged_polygons"] = decoder.refused_records();
  put_metadata(json, header->description.metadata);
  if (!problems.empty()) json["problems"] = std::move(problems);
  return true;
}

bool describe_stream(Json& json, std::span<const std::byte> bytes, const std::string& path,
                     const vrml::Budget& budget) {
  qnv::StreamDecoder decoder(most_decoded_vectors(budget));
  (void)decoder.push(bytes);
  decoder.finish();
  Json problems = Json::array();
  for (const qnv::StreamProblem& problem : decoder.problems())
    problems.push_back("byte " + std::to_string(problem.offset) + ": " + problem.message);
  const qnv::StreamHeader* header = decoder.header();
  if (!header) {
    for (const qnv::StreamProblem& problem : decoder.problems())
      complain("%s: error: byte %llu: %s", path.c_str(), static_cast<unsigned long long>(problem.offset),
               problem.message.c_str());
    return false;
  }
  if (decoder.full())
    complain("%s: error: vectors take %s; the finer ones are not counted", path.c_str(),
             budget.refusal(vrml::Resource::vectors).c_str());
  const qnv::Cloud cloud = decoder.cloud();
  json["payload"] = std::string(qnv::row_of(header->payload).name);
  put_cloud(json, cloud);
  json["vectors_at_full_detail"] = header->vectors;
  json["chunks"] = header->chunks;
  json["palette"] = header->palette.size();
  json["directory_entries"] = decoder.directory().size();
  json["damaged_chunks"] = decoder.refused_chunks() + problems.size();
  if (const qnv::ExactSurface& exact = decoder.exact(); exact.length() > 0) {
    json["exact"] = {{"bytes", exact.length()}, {"come", exact.come()}};
    if (exact.whole()) json["exact"].update({{"bits", exact.bits()}, {"triangles", cloud.triangles.size() / 3}});
  }
  if (const qnv::ProgressiveSurface& progressive = decoder.progressive(); progressive.begun())
    json["progressive"] = {{"bits", progressive.mesh().bits()},
                           {"vertices", progressive.mesh().vertices()},
                           {"triangles", cloud.triangles.size() / 3},
                           {"whole", progressive.mesh().whole()}};
  if (header->payload == qnv::Payload::voxels) {
    const auto& [x, y, z] = header->lattice.dimensions;
    json["dimensions"] = {x, y, z};
  }
  put_levels(json, *header, cloud, bytes);
  put_metadata(json, header->description.metadata);
  if (!problems.empty()) json["problems"] = std::move(problems);
  return true;
}

const char* name_of(qnv::VoxelType type) {
  static constexpr const char* kNames[] = {"u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"};
  return kNames[static_cast<std::size_t>(type)];
}

void describe_volume(Json& json, const qnv::VolumeSource& volume, Clock::time_point deadline) {
  const qnv::VolumeLayout& layout = volume.layout;
  json["dimensions"] = {layout.dimensions[0], layout.dimensions[1], layout.dimensions[2]};
  json["type_of_voxels"] = std::string(name_of(layout.type)) + (layout.big_endian ? "be" : "");
  json["axes"] = {json_of(layout.axes[0]), json_of(layout.axes[1]), json_of(layout.axes[2])};
  json["origin"] = json_of(layout.base + layout.origin);
  float least = std::numeric_limits<float>::infinity(), most = -least;
  std::uint64_t missing = 0, seen = 0;
  std::vector<std::byte> scratch;
  std::vector<float> values(qnv::check(layout) ? 0 : qnv::slice_voxels(layout));
  for (std::uint32_t z = 0; !values.empty() && z < layout.dimensions[2] && Clock::now() < deadline; ++z) {
    if (!qnv::read_slice(volume, z, scratch, values)) break;
    for (const float v : values) {
      missing += v != v ? 1 : 0;
      least = v < least ? v : least;
      most = v > most ? v : most;
    }
    seen += values.size();
  }
  if (least <= most) json["values"] = {least, most};
  if (missing > 0) json["missing_voxels"] = missing;
  if (qnv::check(layout) || seen < qnv::voxel_count(layout)) json["voxels_read"] = seen;
  put_metadata(json, layout.metadata);
}

void describe_world(Json& json, const OpenedSurface& opened) {
  const SurfaceSummary summary = summarize_surface(opened.list);
  const OpenedWorld& world = opened.world;
  std::size_t vectors = 0;
  for (const auto& [node, cloud] : world.clouds)
    vectors += cloud->levels ? static_cast<std::size_t>(cloud->levels->header().vectors) : cloud->size();
  json["title"] = world.title;
  json["nodes"] = world.scene->node_count();
  json["shapes"] = opened.list.items.size() + opened.list.splats.size();
  json["triangles"] = summary.triangles;
  json["vectors"] = vectors;
  json["viewpoints"] = opened.list.viewpoints.size();
  json["images"] = world.images.size();
  json["textured"] = summary.textured;
  json["two_sided"] = summary.two_sided;
  if (!opened.list.bounds.empty()) put_box(json, opened.list.bounds.lower, opened.list.bounds.upper);
  json["errors"] = world.diagnostics.errors();
  json["warnings"] = world.diagnostics.warnings();
}

std::string json_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) {
    char text[32];
    // Where float32 ends, so that a millimetre shows of a place thousands of kilometres away.
    const double number = value.get<double>();
    std::snprintf(text, sizeof text, std::abs(number) < 1e5 ? "%.7g" : "%.11g", number);
    return text;
  }
  if (!value.is_structured()) return value.dump();
  std::string text;
  for (const auto& [key, part] : value.items())
    text += (text.empty()        ? ""
             : value.is_object() ? ", "
                                 : " ") +
            (value.is_object() ? key + " " : std::string()) + json_text(part);
  return text;
}

// A line for each fact; lists of facts and metadata get one for each of theirs.
void print_facts(const Json& json) {
  for (const auto& [key, value] : json.items()) {
    const bool list = value.is_array() && !value.empty() && !value.front().is_number() && !value.front().is_array();
    std::string name = key;
    std::replace(name.begin(), name.end(), '_', ' ');
    if (!list && key != "metadata") {
      print_line("%-22s %s", name.c_str(), json_text(value).c_str());
      continue;
    }
    print_line("%s", name.c_str());
    for (const auto& [inner, part] : value.items())
      print_line("  %s%s", list ? "" : (inner + ": ").c_str(), json_text(part).c_str());
  }
}

}  // namespace

int run_info(const Options& options) {
  const std::string& path = options.files.front();
  const net::Url url = net::parse_url(path);
  const std::string local = url.scheme == "file" ? net::path_of_url(url) : path;
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(std::min(options.timeout_seconds, 1e6)));
  auto mapped = net::map_file(local);
  if (const auto* problem = std::get_if<net::FileError>(&mapped)) return fail(problem->message);
  auto bytes = std::get<net::MappedFile>(mapped).bytes();
  Json json = {{"file", path}, {"type", ""}, {"bytes", bytes.size()}};
  bytes = bytes.first(std::min(bytes.size(), options.max_bytes));
  if (const ContentType* type = content_type_by_mark(bytes); type && type->content == ContentClass::stream) {
    json["type"] = type->name;
    if (!(is_outline_stream(bytes) ? describe_outlines : describe_stream)(json, bytes, path,
                                                                          vrml::Budget(options.limits)))
      return kFailed;
    if (const auto changed = std::get<net::MappedFile>(mapped).changed()) return fail(local + ": " + *changed);
  } else {
    const auto input = open_input(options, path);
    if (!input) return kFailed;
    json["type"] = input->type;
    if (const auto* volume = std::get_if<qnv::VolumeSource>(&input->content)) {
      describe_volume(json, *volume, deadline);
    } else if (const auto* cloud = std::get_if<qnv::Cloud>(&input->content)) {
      put_cloud(json, *cloud);
      put_metadata(json, cloud->description.metadata);
    } else {
      describe_world(json, *std::get<std::unique_ptr<OpenedSurface>>(input->content));
    }
  }
  if (options.json)
    print_text(json.dump(2, ' ', true, Json::error_handler_t::replace) + "\n");
  else
    print_facts(json);
  return kDone;
}

}  // namespace gs::app
