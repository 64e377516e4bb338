// Tests of access of worlds to files of other origins. docs/security.md names these tests.
#include "app/loading/world_loading.h"

#include "app/base/local_file.h"
#include "app/formats/volume/volume.h"
#include "net/base/reference_policy.h"
#include "net/cells/udp.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"
#include "tests/app/worlds.h"
#include "tests/net/memory_network.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app::origins_test {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kHeader = "#VRML V2.0 utf8\n";
constexpr std::string_view kPicture{"GIF89a\1\0\1\0\x80\0\0\xff\0\0\0\0\0,\0\0\0\0\1\0\1\0\0\2\2D\1\0;", 35};

std::string texture(const std::string& urls) {
  return "Shape { appearance Appearance { texture ImageTexture { url [ " + urls + " ] } } geometry Box { } }\n";
}
std::string in_quotes(const std::string& text) { return "\"" + text + "\""; }
std::string text(std::string_view body) { return std::string(kHeader).append(body); }

std::vector<std::byte> bytes_of(std::string_view of) {
  const auto bytes = std::as_bytes(std::span(of.data(), of.size()));
  return {bytes.begin(), bytes.end()};
}

struct Web {
  std::shared_ptr<net::MemoryNetwork> network = std::make_shared<net::MemoryNetwork>();
  LoadOptions options;

  Web() {
    options.memory = net::MakeMemoryTransport{network};
    options.timeout_seconds = 60;
  }
  void put(const std::string& url, std::string_view body, net::AddressSpace space = net::AddressSpace::global) {
    network->put(url, [bytes = bytes_of(body), space](const net::TransferRequest& request, unsigned) {
      net::MemoryResource resource;
      resource.bytes = bytes;
      net::MemoryAnswer answer = net::answer_well(resource, request);
      answer.head.space = space;
      return answer;
    });
  }
  [[nodiscard]] std::size_t asked(const std::string& url) const {
    const auto transfers = network->transfers();
    return static_cast<std::size_t>(
        std::count_if(transfers.begin(), transfers.end(), [&](const auto& one) { return one.url == url; }));
  }
};

std::size_t lines_with(const std::string& all, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = all.find(part); at != std::string::npos; at = all.find(part, at + 1)) ++count;
  return count;
}

/// Counts Inlines with content, at any depth.
std::size_t inlined(const vrml::SceneGraph& scene) {
  std::size_t count = 0;
  for (const auto& [node, content] : scene.inlines().all())
    if (content) count += 1 + inlined(*content);
  return count;
}

}  // namespace

// Files -------------------------------------------------------------------------------------------

TEST_CASE("lets a world read its own folder and below, and above it only allowed files") {
  const ScratchFolder folder;
  folder.write("w/a/own.gif", kPicture);
  folder.write("w/a/deep/below.gif", kPicture);
  folder.write("w/textures/above.gif", kPicture);
  const std::string world =
      folder.write("w/a/world.wrl",
                   text(texture("\"own.gif\"") + texture("\"deep/below.gif\"") + texture("\"../textures/above.gif\"") +
                        texture(in_quotes("file://" + folder.path("w/textures/above.gif")))));
  const std::string outside = fs::canonical(folder.path("w/textures")).string();
  LoadOptions options;
  const LoadedWorld strict = load_world(world, options);
  INFO(said(strict));
  CHECK(strict.images.size() == 2);
  CHECK(strict.outside == std::vector<OutsideFolder>{{outside, "../textures/above.gif"}});
  CHECK(said(strict) == world +
                            ":4:41: warning: ImageTexture: cannot find '../textures/above.gif' (it lies outside of the "
                            "world's folder; --allow " +
                            outside + " allows it)\n");
  options.allowed = {folder.path("w")};
  const LoadedWorld allowed = load_world(world, options);
  CHECK(allowed.images.size() == 4);
  CHECK(allowed.outside.empty());
  CHECK(said(allowed).empty());
  options.allowed = {folder.path("w/textures/above.gif")};  // only this file
  CHECK(load_world(world, options).images.size() == 4);
  options.allowed = {folder.path("w/a")};
  CHECK(load_world(world, options).images.size() == 2);
}

TEST_CASE("reports all files of one folder in one message, and missing files in none") {
  const ScratchFolder folder;
  std::string body;
  for (int i = 0; i < 20; ++i) {
    folder.write("t/" + std::to_string(i) + ".gif", kPicture);
    body += texture("\"../t/" + std::to_string(i) + ".gif\"");
  }
  const LoadedWorld world = load_world(folder.write("w/world.wrl", text(body)));
  CHECK(lines_with(said(world), "--allow") == 1);
  CHECK(world.diagnostics.warnings() == 1);
  CHECK(world.outside.size() == 1);
  const LoadedWorld missing = load_world(folder.write("w/other.wrl", text(texture("\"../none/a.gif\""))));
  CHECK(said(missing).find("--allow") == std::string::npos);
  CHECK(missing.diagnostics.warnings() == 1);
  CHECK(missing.outside.empty());
}

TEST_CASE("judges links by their targets") {
  const ScratchFolder folder;
  folder.write("secret/s.gif", kPicture);
  folder.write("w/own.gif", kPicture);
  fs::create_symlink("own.gif", folder.path("w/in.gif"));
  fs::create_symlink(folder.path("secret/s.gif"), folder.path("w/out.gif"));
  fs::create_directory_symlink(folder.path("secret"), folder.path("w/Way"));
  const LoadedWorld world = load_world(
      folder.write("w/world.wrl", text(texture("\"in.gif\"") + texture("\"out.gif\"") + texture("\"Way/s.gif\"") +
                                       texture("\"way/s.gif\"") + texture("\"OWN.gif\""))));
  CHECK(world.images.size() == 2);
  CHECK(said(world).find("--allow " + fs::canonical(folder.path("secret")).string()) != std::string::npos);
}

TEST_CASE("applies the folder of the world to all its Inlines") {
  const ScratchFolder folder;
  folder.write("t.gif", kPicture);
  folder.write("w/t.gif", kPicture);
  folder.write("w/sub/in.wrl", text(texture("\"../t.gif\"") + texture("\"../../t.gif\"")));
  const LoadedWorld world = load_world(folder.write("w/world.wrl", text("Inline { url \"sub/in.wrl\" }")));
  CHECK(world.images.size() == 1);
  CHECK(lines_with(said(world), "--allow") == 1);
}

TEST_CASE("allows files that the command line names") {
  const ScratchFolder folder;
  folder.write("b/in.wrl", text("Shape { geometry Box { } }"));
  folder.write("c/t.gif", kPicture);
  const std::string world =
      folder.write("a/world.wrl", text("Inline { url \"../b/in.wrl\" }\n" + texture("\"../c/t.gif\"")));
  const std::string snapshot = "--backend osmesa --samples 1 --size 32x24 --snapshot " + quoted(folder.path("o.png"));
  const Run strict = run(snapshot + " " + quoted(world));
  CHECK(strict.status == 0);
  CHECK(lines_with(strict.output, "--allow") == 2);
  const Run allowed = run(snapshot + " --allow " + quoted(folder.path("b")) + " --allow " + quoted(folder.path("c")) +
                          " " + quoted(world));
  CHECK(allowed.status == 0);
  CHECK(allowed.output.empty());
  const Run wrong = run(snapshot + " --allow " + quoted(folder.path("none")) + " " + quoted(world));
  CHECK(wrong.status == 2);
  CHECK(wrong.output.find("--allow: expected an existing folder") != std::string::npos);
  CHECK(run("info " + quoted(world)).output.find("--allow") != std::string::npos);
}

TEST_CASE("finds materials and buffers of meshes in their own folder") {
  const ScratchFolder folder;
  folder.write("m.mtl", "newmtl green\nKd 0 1 0\n");
  folder.write("b.bin", std::string(36, '\0'));
  const std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl green\nf 1 2 3\n";
  const std::string above = folder.write("w/above.obj", "mtllib ../m.mtl\n" + mesh);
  const LoadedWorld refused = load_world(above);
  CHECK(said(refused).find(
            "above.obj:1:1: warning: material library ../m.mtl cannot be read: ../m.mtl: it lies outside") !=
        std::string::npos);
  CHECK(refused.outside.size() == 1);
  LoadOptions options;
  options.allowed = {folder.path("")};
  CHECK(load_world(above, options).diagnostics.warnings() == 0);
  const std::string gltf = folder.write(
      "w/above.gltf",
      R"({"asset":{"version":"2.0"},"buffers":[{"uri":"../b.bin","byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}]})");
  CHECK(said(load_world(gltf)).find("it lies outside") != std::string::npos);
  CHECK(said(load_world(gltf, options)).find("it lies outside") == std::string::npos);
}

// Headers -----------------------------------------------------------------------------------------

namespace {

struct HeaderFormat {
  const char* name;
  std::string (*header)(const std::string& data);
};
const HeaderFormat kHeaderFormats[] = {
    {"v.nhdr",
     [](const std::string& data) {
       return "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: " + data + "\n";
     }},
    {"v.mhd",
     [](const std::string& data) {
       return "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = " + data +
              "\n";
     }},
    {"v.fld",
     [](const std::string& data) {
       return "# AVS field file\nndim=3\ndim1=2\ndim2=2\ndim3=2\nnspace=3\nveclen=1\ndata=byte\nfield=uniform\n"
              "variable 1 file=" +
              data + " filetype=binary\n";
     }},
};
constexpr std::string_view kVoxels = "\0\1\2\3\4\5\6\7";

bool opens(const std::string& path, const std::vector<std::string>& allowed = {}) {
  return std::holds_alternative<qnv::VolumeSource>(open_volume(path, {}, {reader_beside(path, allowed), {}}));
}

}  // namespace

TEST_CASE("restricts a volume header to files of its own folder and below") {
  for (const HeaderFormat& format : kHeaderFormats) {
    INFO(format.name);
    const ScratchFolder folder;
    const std::string voxels(kVoxels.data(), 8);
    folder.write("w/own.raw", voxels);
    folder.write("w/deep/below.raw", voxels);
    folder.write("secret.raw", voxels);
    fs::create_symlink(folder.path("secret.raw"), folder.path("w/link.raw"));
    const auto with = [&](const std::string& data) {
      return folder.write(std::string("w/") + format.name, format.header(data));
    };
    CHECK(opens(with("own.raw")));
    CHECK(opens(with("deep/below.raw")));
    CHECK(opens(with(folder.path("w/own.raw"))));
    CHECK(opens(with("C:\\long\\ago\\own.raw")));  // only the file name is used, in the folder of the header
    CHECK(std::holds_alternative<qnv::VolumeSource>(open_volume(with("own.raw"))));
    for (const std::string& outside : {std::string("../secret.raw"), folder.path("secret.raw"), std::string("link.raw"),
                                       std::string("deep/../../secret.raw")}) {
      INFO(outside);
      const std::string path = with(outside);
      CHECK_FALSE(opens(path));
      CHECK(std::holds_alternative<std::string>(open_volume(path)));
      CHECK(opens(path, {folder.path("")}));
    }
    const auto problem = open_volume(with("../secret.raw"));
    CHECK(std::get<std::string>(problem).find("it lies outside of the world's folder; --allow ") != std::string::npos);
  }
}

TEST_CASE("restricts a header from the network to the network") {
  for (const HeaderFormat& format : kHeaderFormats) {
    INFO(format.name);
    const ScratchFolder folder;
    const std::string secret = folder.write("secret.raw", std::string(kVoxels.data(), 8));
    Web web;
    const std::string world = text("Shape { geometry QNV { url " + in_quotes(format.name) + " } }");
    web.put("memory://a/w/world.wrl", world);
    web.put("memory://a/data/v.raw", std::string(kVoxels.data(), 8));
    const auto with = [&](const std::string& data) {
      web.put(std::string("memory://a/w/") + format.name, format.header(data));
      return load_world("memory://a/w/world.wrl", web.options);
    };
    const LoadedWorld good = with("../data/v.raw");
    INFO(said(good));
    CHECK(good.geometries.size() == 1);
    for (const std::string& data : {secret, "../../../../../../../.." + secret, "file://" + secret}) {
      INFO(data);
      const LoadedWorld bad = with(data);
      CHECK(bad.geometries.empty());
      CHECK(said(bad).find("404") != std::string::npos);  // it was requested over the network
    }
    // The header also fails if it is the document itself.
    const LoadedWorld alone = load_world(std::string("memory://a/w/") + format.name, web.options);
    CHECK_FALSE(alone.scene);
  }
}

// Origins -----------------------------------------------------------------------------------------

TEST_CASE("gives a PROTO from the network only the network's rights in a local world") {
  const ScratchFolder folder;
  const std::string picture = folder.write("p.gif", kPicture);
  folder.write("in.wrl", text("Shape { geometry Box { } }"));
  Web web;
  web.put("memory://lib/lib.wrl", text("PROTO P [ ] { Group { children [ Inline { url \"in.wrl\" } " +
                                       texture("\"p.gif\"") + texture(in_quotes("file://" + picture)) + " ] } }"));
  const std::string world = folder.write("world.wrl", text("EXTERNPROTO P [ ] \"memory://lib/lib.wrl#P\"\nP { }\n"));
  const LoadedWorld alone = load_world(world, web.options);
  REQUIRE(alone.scene);
  INFO(said(alone));
  CHECK(inlined(*alone.scene) == 0);
  CHECK(alone.images.empty());
  CHECK(said(alone).find("memory://lib/lib.wrl:2:") != std::string::npos);  // position of the PROTO in the library
  CHECK(said(alone).find("may not refer to file:") != std::string::npos);
  CHECK(web.asked("memory://lib/in.wrl") == 1);
  CHECK(web.asked("memory://lib/p.gif") == 1);
  // Files beside the library are shown.
  web.put("memory://lib/in.wrl", text("Shape { geometry Sphere { } }"));
  web.put("memory://lib/p.gif", kPicture);
  const LoadedWorld both = load_world(world, web.options);
  CHECK(inlined(*both.scene) == 1);
  CHECK(both.images.size() == 1);
  // A library of files contains only files.
  folder.write("lib/lib.wrl", text("PROTO P [ ] { Group { children [ Inline { url \"deep.wrl\" } ] } }"));
  folder.write("lib/deep.wrl", text("Shape { geometry Box { } }"));
  const LoadedWorld local =
      load_world(folder.write("local.wrl", text("EXTERNPROTO P [ ] \"lib/lib.wrl#P\"\nP { }\n")), web.options);
  CHECK(inlined(*local.scene) == 1);
}

TEST_CASE("resolves a url against the file that wrote it, not the PROTO that receives it") {
  const ScratchFolder folder;
  folder.write("p.gif", kPicture);
  folder.write("default.gif", kPicture);
  Web web;
  web.put("memory://lib/lib.wrl",
          text("PROTO P [ field MFString u \"default.gif\" ] { Shape { appearance Appearance { texture ImageTexture { "
               "url IS u } } geometry Box { } } }"));
  const auto with = [&](const std::string& body) {
    return load_world(
        folder.write("world.wrl", text("EXTERNPROTO P [ field MFString u ] \"memory://lib/lib.wrl#P\"\n" + body)),
        web.options);
  };
  const LoadedWorld given = with("P { u \"p.gif\" }");
  INFO(said(given));
  CHECK(given.images.size() == 1);
  CHECK(with("P { }").images.empty());
  CHECK(with("PROTO Q [ field MFString v \"p.gif\" ] { P { u IS v } } Q { }").images.size() == 1);
  CHECK(web.asked("memory://lib/default.gif") == 1);
}

TEST_CASE("shares no images between texts of different origins, in any order of requests") {
  const ScratchFolder folder;
  const std::string picture = folder.write("p.gif", kPicture);
  const std::string url = in_quotes("file://" + picture);
  Web web;
  web.put("memory://lib/lib.wrl", text("PROTO P [ ] { " + texture(url) + " }"));
  web.put("memory://lib/in.wrl", text(texture(url)));
  const std::string parts[] = {"EXTERNPROTO P [ ] \"memory://lib/lib.wrl#P\"\nP { }\n",
                               "Inline { url \"memory://lib/in.wrl\" }\n", texture(url)};
  for (const std::vector<int>& order : {std::vector<int>{0, 1, 2}, std::vector<int>{2, 1, 0}}) {
    std::string body;
    for (const int part : order) body += parts[part];
    const LoadedWorld world = load_world(folder.write("world.wrl", text(body)), web.options);
    INFO(said(world));
    CHECK(world.images.size() == 1);
  }
  // Texts of one origin share the image, so it is read once.
  web.put("memory://a/p.gif", kPicture);
  web.put("memory://a/1.wrl", text(texture("\"p.gif\"")));
  web.put("memory://a/2.wrl", text(texture("\"p.gif\"")));
  web.put("memory://a/world.wrl", text("Inline { url \"1.wrl\" } Inline { url \"2.wrl\" }"));
  CHECK(load_world("memory://a/world.wrl", web.options).images.size() == 2);
  CHECK(web.asked("memory://a/p.gif") == 1);
}

TEST_CASE("gives a data: text the origin of the text that contains it") {
  const ScratchFolder folder;
  folder.write("in.wrl", text("Shape { geometry Box { } }"));
  folder.write("p.gif", kPicture);
  const std::string data = "data:model/vrml,%23VRML%20V2.0%20utf8%0AInline%20%7B%20url%20%22in.wrl%22%20%7D";
  const LoadedWorld local = load_world(folder.write("world.wrl", text("Inline { url " + in_quotes(data) + " }")));
  INFO(said(local));
  CHECK(inlined(*local.scene) == 2);
  Web web;
  const std::string file =
      "data:model/vrml,%23VRML%20V2.0%20utf8%0AInline%20%7B%20url%20%22file://" + folder.path("in.wrl") + "%22%20%7D";
  web.put("memory://a/world.wrl",
          text("Inline { url " + in_quotes(file) + " } Inline { url " + in_quotes(data) + " }"));
  web.put("memory://a/in.wrl", text("Shape { geometry Box { } }"));
  const LoadedWorld remote = load_world("memory://a/world.wrl", web.options);
  CHECK(inlined(*remote.scene) == 3);  // both texts, and the file beside the document
  CHECK(said(remote).find("may not refer to file:") != std::string::npos);
  // A URL that the user enters has no origin.
  const LoadedWorld given = load_world(file);
  REQUIRE(given.scene);
  CHECK(inlined(*given.scene) == 0);
}

// Hosts -------------------------------------------------------------------------------------------

TEST_CASE("keeps this machine and its networks from a world of the Internet, at any depth") {
  using Space = net::AddressSpace;
  Web web;
  const std::string box = text("Shape { geometry Box { } }");
  const std::string all = "Inline { url \"memory://router/r.wrl\" } Inline { url \"memory://me/m.wrl\" }\n";
  web.put("memory://router/r.wrl", box, Space::local);
  web.put("memory://me/m.wrl", box, Space::loopback);
  web.put("memory://far/far.wrl", text(all));
  web.put("memory://router/in.wrl", text(all), Space::local);
  web.put("memory://router/far.wrl", text("Inline { url \"memory://far/far.wrl\" }"), Space::local);
  web.put("memory://lib/lib.wrl", text("PROTO P [ ] { Group { children [ " + all + " ] } }"));
  const LoadedWorld far = load_world("memory://far/far.wrl", web.options);
  CHECK(inlined(*far.scene) == 0);
  CHECK(said(far).find("its address is of a local network; a document of the Internet may not reach it") !=
        std::string::npos);
  CHECK(inlined(*load_world("memory://router/in.wrl", web.options).scene) == 1);
  CHECK(inlined(*load_world("memory://router/far.wrl", web.options).scene) == 1);  // but no other file of that host
  const ScratchFolder folder;
  CHECK(inlined(*load_world(folder.write("here.wrl", text(all)), web.options).scene) == 2);
  CHECK(inlined(*load_world(folder.write("lib.wrl", text("EXTERNPROTO P [ ] \"memory://lib/lib.wrl#P\"\nP { }")),
                            web.options)
                     .scene) == 0);
}

TEST_CASE("sends datagrams only where the text may reach") {
  Web web;
  const auto world = [&](const std::string& url) {
    web.put("memory://far/w.wrl", text("Shape { geometry QNV { url " + in_quotes(url) + " } }"));
    return said(load_world("memory://far/w.wrl", web.options));
  };
  CHECK(
      world("cells://127.0.0.1:6635/x.qnv").find("127.0.0.1 is of this machine; a document of the Internet may not") !=
      std::string::npos);
  CHECK(world("cells://[::ffff:10.0.0.1]:6635/x.qnv").find("10.0.0.1 is of a local network") != std::string::npos);
  CHECK(world("cells://255.255.255.255:6635/x.qnv").find("is of no single host") != std::string::npos);
  CHECK(world("cells://user:secret@127.0.0.1:6635/x.qnv").find("or password") != std::string::npos);
  CHECK(world("cells://127.0.0.1:53/x.qnv").find("datagrams to port 53") != std::string::npos);
}

TEST_CASE("greets few unresponsive servers at a time") {
  auto opened = net::UdpSocket::open(0, true);
  REQUIRE(std::holds_alternative<net::UdpSocket>(opened));
  auto& silent = std::get<net::UdpSocket>(opened);
  std::string body;
  for (int i = 0; i < 12; ++i)
    body += "Shape { geometry QNV { url \"cells://127.0.0.1:" + std::to_string(silent.port()) + "/" +
            std::to_string(i) + ".qnv\" } }\n";
  const ScratchFolder folder;
  LoadOptions options;
  options.timeout_seconds = 1;
  const LoadedWorld world = load_world(folder.write("world.wrl", text(body)), options);
  CHECK(world.geometries.empty());
  std::set<net::Endpoint> clients;
  std::size_t count = 0;
  net::Endpoint from;
  while (const auto datagram = silent.receive(from)) {
    CHECK(datagram->size() == net::kHelloBytes);
    clients.insert(from);
    ++count;
  }
  CHECK(count > 0);
  CHECK(clients.size() <= 4);
}

}  // namespace gs::app::origins_test
