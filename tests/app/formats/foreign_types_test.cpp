#include "app/formats/foreign_types.h"

#include "app/formats/common/asset.h"
#include "tests/app/formats_helpers.h"
#include "tests/app/scratch_folder.h"

#include <filesystem>
#include <set>
#include <string>
#include <utility>

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace {

std::string zeros(std::size_t count) { return std::string(count, '\0'); }

std::string zip_with(const std::string& name) {
  std::string zip = std::string("PK\x03\x04", 4) + zeros(26) + name;
  zip[26] = static_cast<char>(name.size());
  return zip;
}

}  // namespace

TEST_CASE("recognises formats that are not read by their first bytes") {
  const std::string iges = std::string(72, ' ') + "S      1\n";
  const std::pair<std::string, const char*> samples[] = {
      {std::string("\xe0\0\0\x01\0\x02", 6), "X3D in binary encoding (Fast Infoset)"},
      {"ISO-10303-21;\nHEADER;", "STEP"},
      {"ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC4'));", "IFC"},
      {"#usda 1.0\n", "USD"},
      {"PXR-USDC" + zeros(8), "USD"},
      {zip_with("model.usdc"), "USD (usdz archive)"},
      {zip_with("3D/3dmodel.model"), "3MF"},
      {zip_with("readme.txt"), "ZIP archive"},
      {"Kaydara FBX Binary  ", "FBX"},
      {"; FBX 7.4.0 project file", "FBX"},
      {"<?xml version=\"1.0\"?><COLLADA xmlns='x'>", "COLLADA"},
      {"<VTKFile type=\"HyperTreeGrid\">", "VTK XML of another type"},
      {"<!-- a --><robot name='r2d2'>", "URDF"},
      {iges, "IGES"},
      {"LASF", "LAS"},
      {"BLENDER-v300", "Blender"},
      {"\x93NUMPY", "NumPy array"},
      {"\x89PNG\r\n\x1a\n", "PNG"},
      {"version https://git-lfs.github.com/spec/v1\n", "Git LFS pointer"},
      {"<!DOCTYPE html>\n<html>", "HTML page"},
      {"<HTML><HEAD>", "HTML page"},
      {"<note>", "XML of an unknown kind"},
      {"\x01\x02\x03" + zeros(60), "data of an unknown format"},
  };
  for (const auto& [text, name] : samples) {
    INFO(name);
    const ContentType& type = content_type_of("x", bytes_of(text));
    CHECK(std::string(type.name) == name);
    CHECK(content_type_by_mark(bytes_of(text)) == nullptr);
    Diagnostics diagnostics;
    CHECK(
        std::holds_alternative<std::monostate>(read_asset(type, {bytes_of(text), "x", {}, own_budget(), diagnostics})));
    REQUIRE(diagnostics.errors() == 1);
    CHECK(diagnostics.entries()[0].message == std::string(name) + " cannot be read; " + std::string(type.remedy));
  }
  // UTF-16, as some exporters write it.
  std::string wide = "\xff\xfe";
  for (const char c : std::string("<?xml version='1.0'?><COLLADA>")) wide += {c, '\0'};
  CHECK(content_type_of("x", bytes_of(wide)).name == "COLLADA");
}

TEST_CASE("each row of a foreign format has a remedy, and no readable format shares its name or extension") {
  std::set<std::string_view> names, extensions;
  for (const ContentType& type : foreign_types()) {
    INFO(type.name);
    CHECK(names.insert(type.name).second);
    CHECK_FALSE(type.remedy.empty());
    CHECK((type.sniff || !type.extensions.empty()));
    for (const ContentType& known : content_types()) {
      CHECK(known.name != type.name);
      CHECK(known.remedy.empty());
      if (known.sniff) CHECK_FALSE((type.sniff && type.sniff(bytes_of("#VRML V2.0 utf8\n"))));
    }
    std::string_view rest = type.extensions;
    while (!rest.empty()) {
      const std::string_view extension = rest.substr(0, rest.find(' ') + 1);
      CHECK(extensions.insert(extension).second);
      for (const ContentType& known : content_types())
        CHECK(known.extensions.find(extension) == std::string_view::npos);
      rest.remove_prefix(extension.size());
    }
  }
}

TEST_CASE("recognises a foreign format by its extension, but trusts the first bytes more") {
  CHECK(content_type_of("part.STP", {}).name == "STEP");
  CHECK(content_type_of("a.usdz", {}).name == "USD (usdz archive)");
  CHECK(content_type_of("a.dcm", bytes_of(zeros(40))).name == "DICOM");
  CHECK(content_type_of("a", bytes_of(std::string("II*\0", 4) + zeros(124) + "DICM")).name == "DICOM");
  CHECK(content_type_of("a", bytes_of(std::string("MM\0*", 4))).name == "TIFF");
  CHECK(content_type_of("a.step", bytes_of("#VRML V2.0 utf8\n")).name == "VRML97");
  CHECK(content_type_of("a.wrl", bytes_of("\x89HDF\r\n\x1a\n")).name == "HDF5");
  CHECK(content_type_of("a.wrl", bytes_of("Shape { }")).name == "VRML97");
  CHECK(content_type_of("a.raw", bytes_of(zeros(40))).name == "raw voxels");
}

TEST_CASE("a folder that is opened like a file gets a message with a remedy") {
  const ScratchFolder folder;
  const auto make = [&](const char* name, const char* file) {
    std::filesystem::create_directories(folder.path(name));
    folder.write(std::string(name) + "/" + file, "{}");
    return refusal_of_folder(folder.path(name)).value_or("");
  };
  CHECK(make("store", "image/zarr.json").find("Zarr") != std::string::npos);
  CHECK(make("images", "I10").find("ghostspace serve") != std::string::npos);
  CHECK(make("other", "x.wrl").find("ghostspace serve") != std::string::npos);
  CHECK_FALSE(refusal_of_folder(folder.path("other/x.wrl")));
  CHECK_FALSE(refusal_of_folder(folder.path("missing")));
}
