#include "tests/simulation/served_files.h"

#include "qnv/codecs/encode.h"
#include "tests/qnv/surface_shapes.h"
#include "tests/qnv/volume_sources.h"
#include "tests/simulation/trace.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <variant>

#include <fcntl.h>
#include <sys/stat.h>

namespace gs::simulation {
namespace {

Bytes shared(std::vector<std::byte> bytes) { return std::make_shared<const std::vector<std::byte>>(std::move(bytes)); }

Bytes encoded(const qnv::EncodeSource& source, qnv::Payload payload, std::size_t vectors) {
  qnv::EncodeRequest request;
  request.payload = payload;
  request.options.vectors = vectors;
  auto made = qnv::encode(source, std::move(request));
  if (const auto* problem = std::get_if<qnv::EncodeError>(&made)) throw Violation(problem->message);
  return shared(std::move(std::get<qnv::Encoding>(made).stream.bytes));
}

Bytes surface(int steps, qnv::Payload payload, std::size_t vectors) {
  qnv::Triangles triangles = qnv::sphere(steps);
  for (qnv::Triangle& triangle : triangles)
    for (glm::vec3& p : triangle.positions)
      p *= 1 + 0.1f * std::sin(9 * p.x) * std::sin(8 * p.y + 1) * std::sin(7 * p.z + 2);
  const qnv::TriangleSource source = [&](const qnv::TriangleSink& sink) { return sink(triangles); };
  return encoded(std::cref(source), payload, vectors);
}

Bytes volume(std::uint32_t edge) {
  qnv::VolumeLayout layout;
  layout.dimensions = {edge, edge, edge};
  const auto source = test::volume_of(layout, [edge](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    const float scale = 9.0f / static_cast<float>(edge);
    return 100 * std::sin(scale * static_cast<float>(x)) * std::cos(scale * static_cast<float>(y)) +
           50 * std::sin(scale * scale * static_cast<float>(z * x) * 3);
  });
  return encoded(std::cref(source), qnv::Payload::values, 0);
}

Bytes text(std::size_t lines) {
  std::string all = "#VRML V2.0 utf8\n";
  for (std::size_t i = 0; i < lines; ++i) all += "Transform { translation " + std::to_string(i) + " 0 0 }\n";
  const auto bytes = std::as_bytes(std::span(all));
  return shared({bytes.begin(), bytes.end()});
}

}  // namespace

const std::vector<Content>& contents() {
  static const std::vector<Content> all = {
      {"octree.qnv", {surface(150, qnv::Payload::packed, 60'000), surface(130, qnv::Payload::packed, 50'000)}},
      {"records.qnv", {surface(60, qnv::Payload::records, 20'000), surface(60, qnv::Payload::records, 15'000)}},
      {"displaced.qnv", {surface(60, qnv::Payload::displaced, 0), surface(50, qnv::Payload::displaced, 0)}},
      {"values.qnv", {volume(56), volume(48)}},
      {"world.wrl", {text(4000), text(3500)}},
      {"small.wrl", {text(3), text(5)}},
  };
  return all;
}

ServedFiles::ServedFiles() {
  std::string name = (std::filesystem::temp_directory_path() / "ghostspace-simulation-XXXXXX").string();
  require(::mkdtemp(name.data()) != nullptr, "cannot create a temporary folder");
  base_ = name;
  std::filesystem::create_directories(folder());
}

ServedFiles::~ServedFiles() {
  std::error_code error;
  std::filesystem::remove_all(base_, error);
}

void ServedFiles::put(const Content& content, int version, std::int64_t modified) const {
  const std::string path = folder() + "/" + content.name, part = base_ + "/part";
  const auto& bytes = *content.versions[version];
  std::ofstream(part, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const timespec times[2] = {{modified, 0}, {modified, 0}};
  require(::utimensat(AT_FDCWD, part.c_str(), times, 0) == 0, "cannot set the time of a file");
  std::filesystem::rename(part, path);
}

}  // namespace gs::simulation
