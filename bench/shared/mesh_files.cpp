#include "bench/shared/mesh_files.h"

#include "app/encode/surface_triangles.h"

#include <zlib.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <span>

namespace gs::bench {

Mesh welded(const render::RenderList& list) {
  Mesh mesh;
  std::map<std::array<float, 3>, unsigned> seen;
  app::for_each_triangle(list, [&](std::span<const qnv::Triangle> triangles) {
    for (const qnv::Triangle& t : triangles)
      for (const glm::vec3& p : t.positions) {
        const auto [at, fresh] =
            seen.emplace(std::array<float, 3>{p.x, p.y, p.z}, static_cast<unsigned>(mesh.positions.size() / 3));
        if (fresh) mesh.positions.insert(mesh.positions.end(), {p.x, p.y, p.z});
        mesh.indices.push_back(at->second);
      }
    return true;
  });
  return mesh;
}

bool write_obj(const Mesh& mesh, const std::string& path) {
  std::ofstream out(path);
  char line[96];
  for (std::size_t i = 0; i + 2 < mesh.positions.size(); i += 3) {
    std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", mesh.positions[i], mesh.positions[i + 1],
                  mesh.positions[i + 2]);
    out << line;
  }
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    out << "f " << mesh.indices[i] + 1 << ' ' << mesh.indices[i + 1] + 1 << ' ' << mesh.indices[i + 2] + 1 << '\n';
  return static_cast<bool>(out.flush());
}

std::string vrml_text(const Mesh& mesh, float crease_angle) {
  char line[96];
  std::snprintf(line, sizeof line, "%.3g", static_cast<double>(crease_angle));
  std::string text =
      "#VRML V2.0 utf8\nShape{appearance Appearance{material Material{}}geometry IndexedFaceSet{creaseAngle " +
      std::string(line) + " solid FALSE coord Coordinate{point[\n";
  for (std::size_t i = 0; i + 2 < mesh.positions.size(); i += 3) {
    std::snprintf(line, sizeof line, "%.6g %.6g %.6g\n", mesh.positions[i], mesh.positions[i + 1],
                  mesh.positions[i + 2]);
    text += line;
  }
  text += "]}coordIndex[\n";
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    std::snprintf(line, sizeof line, "%u %u %u -1\n", mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]);
    text += line;
  }
  text += "]}}\n";
  return text;
}

std::string gzipped(const std::string& text) {
  constexpr int kWindow = 15 + 16;  // with gzip's header and trailer
  z_stream stream{};
  if (deflateInit2(&stream, 9, Z_DEFLATED, kWindow, 8, Z_DEFAULT_STRATEGY) != Z_OK) return {};
  std::string packed(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const bool whole = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  packed.resize(whole ? stream.total_out : 0);
  deflateEnd(&stream);
  return packed;
}

bool make_draco(const std::string& base, int bits) {
  const std::string command = "draco_encoder -i '" + base + ".obj' -o '" + base + ".drc' -cl 10 -qp " +
                              std::to_string(bits) + " >/dev/null 2>&1 && draco_decoder -i '" + base + ".drc' -o '" +
                              base + ".out.obj' >/dev/null 2>&1";
  return std::system(command.c_str()) == 0;
}

}  // namespace gs::bench
