#include "app/formats/common/byte_order.h"
#include "app/formats/export/export.h"
#include "app/formats/export/export_discs.h"
#include "app/formats/splats/splats.h"

#include <cmath>
#include <initializer_list>

namespace gs::app {
namespace {

/// Appends text to bytes.
void put_text(std::vector<std::byte>& to, std::string_view text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  to.insert(to.end(), first, first + text.size());
}

void put_header(std::vector<std::byte>& to, std::size_t count, std::initializer_list<const char*> properties,
                std::size_t faces = 0) {
  put_text(to,
           "ply\nformat binary_little_endian 1.0\ncomment GhostSpace\nelement vertex " + std::to_string(count) + "\n");
  for (const char* property : properties) put_text(to, std::string("property ") + property + "\n");
  if (faces > 0) put_text(to, "element face " + std::to_string(faces) + "\nproperty list uchar uint vertex_indices\n");
  put_text(to, "end_header\n");
}

void put_vector(std::vector<std::byte>& to, const glm::vec3& v) {
  put_little(to, v.x);
  put_little(to, v.y);
  put_little(to, v.z);
}

}  // namespace

Exported export_points_ply(const qnv::Cloud& cloud, const ExportOptions&) {
  const ExportDiscs discs(cloud);
  constexpr std::size_t kRowBytes = 31, kFaceBytes = 13, kHeaderRoom = 512;
  const std::size_t faces = cloud.triangles.size() / 3;
  std::vector<std::byte> bytes;
  bytes.reserve(kHeaderRoom + discs.size() * kRowBytes + faces * kFaceBytes);
  put_header(bytes, discs.size(),
             {"float x", "float y", "float z", "float nx", "float ny", "float nz", "uchar red", "uchar green",
              "uchar blue", "float area"},
             faces);
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const ExportDisc disc = discs[i];
    put_vector(bytes, disc.position);
    put_vector(bytes, disc.normal);
    put_little(bytes, disc.color.r);
    put_little(bytes, disc.color.g);
    put_little(bytes, disc.color.b);
    put_little(bytes, disc.area);
  }
  for (std::size_t i = 0; i < 3 * faces; ++i) {
    if (i % 3 == 0) put_little(bytes, std::uint8_t{3});
    put_little(bytes, cloud.triangles[i]);
  }
  return bytes;
}

Exported export_splats_ply(const qnv::Cloud& cloud, const ExportOptions&) {
  const std::vector<ExportSplat> splats = splats_of(cloud, kFromRightDownForward);
  constexpr std::size_t kRowBytes = 68, kHeaderRoom = 512;
  std::vector<std::byte> bytes;
  bytes.reserve(kHeaderRoom + splats.size() * kRowBytes);
  put_header(bytes, splats.size(),
             {"float x", "float y", "float z", "float nx", "float ny", "float nz", "float f_dc_0", "float f_dc_1",
              "float f_dc_2", "float opacity", "float scale_0", "float scale_1", "float scale_2", "float rot_0",
              "float rot_1", "float rot_2", "float rot_3"});
  for (const ExportSplat& splat : splats) {
    put_vector(bytes, splat.position);
    put_vector(bytes, splat.normal);
    put_vector(bytes, splat.dc);
    put_little(bytes, std::log(splat.opacity / (1 - splat.opacity)));
    for (int k = 0; k < 3; ++k) put_little(bytes, std::log(splat.scale[k]));
    for (const float q : {splat.rotation.w, splat.rotation.x, splat.rotation.y, splat.rotation.z}) put_little(bytes, q);
  }
  return bytes;
}

}  // namespace gs::app
