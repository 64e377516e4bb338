// Tests of EXTERNPROTOs with PROTOs of their own file, and of missing ones.
#include "app/loading/world_loading.h"

#include "tests/app/formats_helpers.h"
#include "tests/app/scratch_folder.h"
#include "tests/app/worlds.h"
#include "tests/net/memory_network.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

using namespace gs;
using namespace gs::app;

namespace {

/// Colours that a world shows, and its diagnostics.
struct Shown {
  std::vector<glm::vec3> colors;
  std::string messages;
};

Shown show(const std::string& path, const LoadOptions& options = {}) {
  WorldLoading loading(path, options);
  while (!loading.done()) (void)loading.step(std::chrono::milliseconds(50));
  const render::RenderList list = loading.collect({0, 0, 10});
  Shown shown;
  for (const render::DrawItem& item : list.items) shown.colors.push_back(item.material.emissive);
  shown.messages = said(loading.take());
  return shown;
}

const std::string kHeader = "#VRML V2.0 utf8\n";
const std::string kX =
    "PROTO X [ field SFColor c 1 0 0 ] { Shape { appearance Appearance { material Material { emissiveColor IS c } } "
    "geometry Box { } } }\n";
const glm::vec3 kRed(1, 0, 0), kGreen(0, 1, 0), kBlue(0, 0, 1);

}  // namespace

TEST_CASE("accepts an EXTERNPROTO that names a PROTO of its own file (VRML97 4.9.2)") {
  const ScratchFolder folder;
  const std::string nodes = "Y { } Y { c 0 1 0 }\n";
  // The EXTERNPROTO is before and after the PROTO. Its URL is a fragment alone, the file's name with a fragment, or
  // without the PROTO's name.
  for (const std::string url : {"\"#X\"", "\"my world.wrl#X\"", "\"my%20world.wrl\"", "[ \"gone.wrl#X\" \"#X\" ]"})
    for (const bool before : {true, false}) {
      const std::string declared = "EXTERNPROTO Y [ field SFColor c ] " + url + "\n";
      const Shown shown = show(folder.write(
          "my world.wrl",
          kHeader + (before ? declared + nodes + kX : kX + "PROTO Z [ ] { Group { } }\n" + declared + nodes)));
      INFO(url << ": " << shown.messages);
      CHECK(shown.messages.empty());
      CHECK(shown.colors == std::vector<glm::vec3>{kRed, kGreen});
    }
}

TEST_CASE("loads an EXTERNPROTO of its own file in pieces, and in libraries") {
  auto network = std::make_shared<net::MemoryNetwork>();
  LoadOptions options;
  options.memory = net::MakeMemoryTransport{network};
  const auto put = [&](const std::string& url, std::string_view text) {
    net::MemoryResource resource;
    resource.bytes = test::bytes_of(text);
    network->put(url, std::move(resource));
  };
  put("memory://a/main.wrl", kHeader + "EXTERNPROTO L [ field SFColor c ] \"lib.wrl#L\"\nL { c 0 0 1 }\nL { }\n");
  put("memory://a/lib.wrl", kHeader + "EXTERNPROTO Own [ field SFColor c ] \"#X\"\n" +
                                "PROTO L [ field SFColor c 0 1 0 ] { Own { c IS c } }\n" + kX);
  Shown shown = show("memory://a/main.wrl", options);
  INFO(shown.messages);
  CHECK(shown.messages.empty());
  CHECK(shown.colors == std::vector<glm::vec3>{kBlue, kGreen});
  // A library's PROTO uses a PROTO of a second library, which passes on the PROTO of a third. Other references of the
  // libraries are not read.
  put("memory://a/lib.wrl", kHeader + "EXTERNPROTO Two [ field SFColor c ] \"two.wrl#Two\"\n" +
                                "EXTERNPROTO Gone [ ] \"gone.wrl\"\nPROTO Unused [ ] { Gone { } }\n" +
                                "PROTO L [ field SFColor c 0 1 0 ] { Group { children Two { c IS c } } }\n");
  put("memory://a/two.wrl", kHeader + "EXTERNPROTO Two [ field SFColor c ] \"three.wrl#X\"\n");
  put("memory://a/three.wrl", kHeader + kX);
  shown = show("memory://a/main.wrl", options);
  INFO(shown.messages);
  CHECK(shown.messages.find("EXTERNPROTO Gone") == std::string::npos);
  CHECK(shown.colors == std::vector<glm::vec3>{kBlue, kGreen});
}

TEST_CASE("uses the PROTO name of the URL that loads (VRML97 4.9.3)") {
  const ScratchFolder folder;
  (void)folder.write("lib.wrl", kHeader + "PROTO First [ ] { Group { } }\n" + kX +
                                    "PROTO Second [ field SFColor c 0 1 0 ] { Shape { appearance Appearance { material "
                                    "Material { emissiveColor IS c } } geometry Box { } } }\n");
  const auto colors = [&](const std::string& text) {
    const Shown shown = show(folder.write("a.wrl", kHeader + text));
    UNSCOPED_INFO(shown.messages);
    CHECK(shown.messages.empty());
    return shown.colors;
  };
  const std::string fields = " [ field SFColor c ] ", both = "P { c 1 0 0 } Q { }\n";
  CHECK(colors("EXTERNPROTO P [ ] [ \"urn:x:node:P\" \"lib.wrl#Second\" ] P { }\n") == std::vector<glm::vec3>{kGreen});
  // Two types share the file, although their first URLs have other names.
  CHECK(colors("EXTERNPROTO P" + fields + "[ \"gone.wrl#A\" \"lib.wrl#X\" ] EXTERNPROTO Q" + fields +
               "[ \"gone.wrl#B\" \"lib.wrl#Second\" ]\n" + both) == std::vector<glm::vec3>{kRed, kGreen});
  // A later URL of the same file has the name.
  CHECK(colors("EXTERNPROTO P" + fields + "[ \"lib.wrl#Gone\" \"lib.wrl#X\" ] P { c 0 0 1 }\n") ==
        std::vector<glm::vec3>{kBlue});
  // In an Inline.
  (void)folder.write("inner.wrl", kHeader + "EXTERNPROTO P" + fields + "[ \"urn:x:node:P\" \"lib.wrl#X\" ] P { }\n");
  CHECK(colors("Inline { url \"inner.wrl\" }\n") == std::vector<glm::vec3>{kRed});
}

TEST_CASE("reports a missing or recursive EXTERNPROTO of its own file, and shows the rest") {
  const ScratchFolder folder;
  const Shown missing =
      show(folder.write("a.wrl", kHeader + "EXTERNPROTO Y [ field SFColor c ] \"#Q\"\nY { }\n" + kX + "X { }\n"));
  CHECK(missing.colors == std::vector<glm::vec3>{kRed});
  CHECK(missing.messages.find("a.wrl:2:13: error: no PROTO 'Q' in this file for EXTERNPROTO Y") != std::string::npos);
  // The PROTO is inside its own body, directly and indirectly.
  for (const std::string text :
       {"EXTERNPROTO Y [ ] \"#P\"\nPROTO P [ ] { Group { children Y { } } }\nP { } X { }\n",
        "EXTERNPROTO Y [ ] \"#P\"\nEXTERNPROTO Z [ ] \"#Q\"\nPROTO P [ ] { Group { children Z { } } }\n"
        "PROTO Q [ ] { Group { children Y { } } }\nP { } Q { } X { }\n",
        "EXTERNPROTO Y [ ] \"#Y\"\nY { } X { }\n"}) {
    const Shown shown = show(folder.write("b.wrl", kHeader + kX + text));
    INFO(shown.messages);
    CHECK(shown.colors == std::vector<glm::vec3>{kRed});
    CHECK(shown.messages.find("error: ") != std::string::npos);
  }
}

TEST_CASE("shows the children of an EXTERNPROTO that cannot be loaded, with one warning per type") {
  const ScratchFolder folder;
  const std::string box =
      "Shape { appearance Appearance { material Material { emissiveColor 1 0 0 } } geometry Box { } }";
  const Shown shown = show(folder.write(
      "a.wrl", kHeader +
                   "EXTERNPROTO Region [ exposedField MFNode children eventIn MFNode addChildren field SFString note ] "
                   "[ \"urn:nobody:Region\" \"gone.wrl\" ]\n"
                   "EXTERNPROTO Other [ field MFNode children ] \"gone.wrl#Other\"\n"
                   "EXTERNPROTO Nothing [ field SFFloat a ] \"gone2.wrl\"\n"
                   "Region { children " +
                   box + " } Region { note \"x\" children [ " + box + " ] } Other { children " + box +
                   " }\nNothing { a 3 }\n"));
  CHECK(shown.colors == std::vector<glm::vec3>{kRed, kRed, kRed});
  const auto count = [&](const std::string& what) {
    std::size_t found = 0;
    for (auto at = shown.messages.find(what); at != std::string::npos; at = shown.messages.find(what, at + 1)) ++found;
    return found;
  };
  INFO(shown.messages);
  const std::pair<const char*, std::size_t> counts[] = {
      {"a.wrl:2:13: warning: EXTERNPROTO Region: cannot find 'urn:nobody:Region' or the 1 others", 1},
      {"EXTERNPROTO Region", 1},
      {"EXTERNPROTO Other: cannot find 'gone.wrl#Other'", 1},
      {"a stand-in replaces it", 2},
      {"EXTERNPROTO Nothing: cannot find 'gone2.wrl'", 1},
      {"warning: ", 3},
      {"error: ", 0},
  };
  for (const auto& [text, times] : counts) CHECK(count(text) == times);
}

TEST_CASE("resolves an EXTERNPROTO by a urn of a standard node or a stand-in") {
  const ScratchFolder folder;
  const std::string material = "appearance Appearance { material Material { emissiveColor 1 0 0 } } ";
  const Shown shown = show(
      folder.write("a.wrl", kHeader +
                                "EXTERNPROTO Fruit [ field SFNode appearance exposedField SFNode geometry ] "
                                "[ \"gone.wrl\" \"urn:web3d:vrml97:node:Shape\" ]\n"
                                "EXTERNPROTO Place [ exposedField MFNode children eventIn SFVec3f set_translation ] "
                                "\"urn:web3d:vrml97:node:Transform\"\n"
                                "EXTERNPROTO Hider [ field MFNode children field SFBool enabled ] "
                                "\"urn:inet:blaxxun.com:node:Occlusion\"\n"
                                "EXTERNPROTO Unknown [ field SFFloat a ] \"urn:inet:blaxxun.com:node:Nobody\"\n"
                                "Place { children Fruit { " +
                                material + "geometry Box { } } }\nHider { children Shape { " + material +
                                "geometry Box { } } }\n" + "Unknown { }\n"));
  INFO(shown.messages);
  CHECK(shown.colors == std::vector<glm::vec3>{kRed, kRed});
  CHECK(shown.messages.find("Fruit") == std::string::npos);
  CHECK(shown.messages.find("Place") == std::string::npos);
  CHECK(shown.messages.find("EXTERNPROTO Hider: cannot find") != std::string::npos);
  CHECK(shown.messages.find("EXTERNPROTO Unknown: cannot find") != std::string::npos);
  CHECK(shown.messages.find("error: ") == std::string::npos);
}

TEST_CASE("has stand-ins for nodes of Blaxxun and Cosmo worlds, with and without EXTERNPROTO") {
  const ScratchFolder folder;
  const std::string box =
      "Shape { appearance Appearance { material Material { emissiveColor 1 0 0 } } geometry Box { } }";
  for (const std::string type : {"Occlusion", "BspGroup", "HUD", "Layer2D", "Layer3D"}) {
    const std::string body = type + " { enabled FALSE children " + box + " }\n";
    const Shown declared = show(folder.write(
        "a.wrl", kHeader + "EXTERNPROTO " + type +
                     " [ exposedField MFNode children exposedField SFBool enabled ] \"urn:inet:blaxxun.com:node:" +
                     type + "\"\n" + body));
    const Shown undeclared = show(folder.write("a.wrl", kHeader + body + body));
    INFO(type << ": " << declared.messages << undeclared.messages);
    CHECK(declared.colors == std::vector<glm::vec3>{kRed});
    CHECK(undeclared.colors == std::vector<glm::vec3>{kRed, kRed});
    CHECK(declared.messages.find("error: ") == std::string::npos);
    // Warns once, and skips fields that the stand-in lacks.
    const std::string warning = "a.wrl:2:1: warning: '" + type +
                                "' is not a VRML97 node, but an extension of other browsers; a stand-in replaces it\n";
    CHECK(undeclared.messages.ends_with(warning));
    CHECK(undeclared.messages.find('\n') + 1 == undeclared.messages.size());
  }
}
