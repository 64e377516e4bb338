#include "app/commands/options/command_line.h"

#include "app/base/exit_status.h"
#include "app/commands/options/options.h"
#include "app/serve/archive.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <utility>

using namespace gs::app;

namespace {

const std::string kBox =
    "#VRML V2.0 utf8\nShape { appearance Appearance { material Material { } } geometry Box { } }\n";

}  // namespace

TEST_CASE("lists every option of the table once in the help and in the manual page") {
  std::set<std::string_view> names;
  std::map<std::string_view, Run> helps;
  const std::string manual = manual_page();
  for (const OptionRow& row : option_rows()) {
    CHECK(names.insert(row.name).second);
    std::string roff(row.name);
    for (std::size_t i = 0; (i = roff.find('-', i)) != std::string::npos; i += 2) roff.replace(i, 1, "\\-");
    CHECK((manual.find("\n.B " + roff) != std::string::npos) == !row.former);
    for (const CommandRow& command : command_rows()) {
      if (!accepts(command, row)) continue;
      auto [entry, added] = helps.try_emplace(command.name);
      Run& help = entry->second;
      if (added) help = run(command.name == "open" ? "--help" : std::string(command.name) + " --help");
      CHECK(help.status == kDone);
      CHECK((help.output.find(row.name) != std::string::npos) == !row.former);
    }
  }
}

TEST_CASE("sets each option in the struct of every command that accepts it") {
  for (const OptionRow& row : option_rows())
    for (const CommandRow& command : command_rows()) {
      if (!accepts(command, row)) continue;
      INFO(command.name << " " << row.name);
      const auto options = command.calls.defaults();
      CHECK_NOTHROW(row.set(*options, ""));
    }
}

TEST_CASE("applies options before the name of a command to that command") {
  const ScratchFolder folder;
  const std::string world = quoted(folder.write("box.wrl", kBox));
  const Run cut = run("--max-bytes 30 check " + world);
  CHECK(cut.status == kFailed);
  CHECK(cut.output == run("check --max-bytes 30 " + world).output);
  CHECK(run("--max-bytes many check " + world).status == kUsage);
}

TEST_CASE("reports wrong usage in one clear line with status 2") {
  for (const char* arguments :
       {"--size 0x0 a.wrl", "--size big a.wrl", "--nonsense", "check", "print a b", "--orbit 1 a.wrl",
        "--background 2,0,0 a.wrl", "--headlight maybe a.wrl", "--backend metal a.wrl", "--timeout -1 a.wrl",
        "--snapshot out.png a.wrl b.wrl", "--samples 0 a.wrl", "--max-bytes many a.wrl", "serve --host a/b .",
        "serve --cors example.org .", "serve --proxies 10.0.0.0/33 .", "serve --host '' .",
        "serve --connections 0 .", "serve --max-age -1 .", "serve --max-age 10y ."}) {
    const Run result = run(arguments);
    INFO(arguments << "\n" << result.output);
    CHECK(result.status == kUsage);
    CHECK(result.output.starts_with("ghostspace: "));
  }
}

TEST_CASE("check reports errors with their positions, and measures files") {
  const ScratchFolder folder;
  const std::string good = folder.write("good.wrl", kBox),
                    bad = folder.write("bad.wrl", "#VRML V2.0 utf8\nShape { bogus 1 }\n");
  CHECK(run("check " + quoted(good)).status == kDone);
  CHECK(run("check " + quoted(good)).output.empty());
  const Run result = run("check --stats " + quoted(folder.path("s.json")) + " " + quoted(good) + " " + quoted(bad));
  CHECK(result.status == kFailed);
  CHECK(result.output == bad + ":2:9: error: Shape has no field 'bogus'; skipped\n");
  const auto stats = nlohmann::json::parse(folder.read("s.json"));
  CHECK(stats["bytes"] == kBox.size() + 34);
  CHECK(stats["nodes"] == 5);
  CHECK(stats["peak_rss_bytes"] > 100000);
  CHECK(stats["parse_s"] > 0);
  const Run shown = run("check --stats - " + quoted(good));
  CHECK(shown.status == 0);
  CHECK(nlohmann::json::parse(shown.output)["bytes"] == kBox.size());
}

TEST_CASE("print writes VRML97 that prints the same again") {
  const ScratchFolder folder;
  const Run first = run("print " + quoted(folder.write("a.wrl", kBox)));
  CHECK(first.status == kDone);
  const Run second = run("print " + quoted(folder.write("b.wrl", first.output)));
  CHECK(second.output == first.output);
  CHECK(run("print " + quoted(folder.path("missing.wrl"))).status == kFailed);
}

TEST_CASE("nodes prints the table as PROTOs that parse, and as Markdown") {
  const ScratchFolder folder;
  const Run text = run("nodes");
  CHECK(text.status == kDone);
  CHECK(text.output.find("PROTO Box [") != std::string::npos);
  CHECK(run("nodes --wrl").output == text.output);
  const Run markdown = run("nodes --markdown");
  CHECK(markdown.output.find("| field | SFVec3f | size | 2 2 2 | (0,inf) |") != std::string::npos);
}

TEST_CASE("fetch reports the received bytes, the time of the first picture and the losses") {
  const ScratchFolder folder;
  const std::string world = folder.write("box.wrl", kBox);
  const Run file = run("fetch --json " + quoted(world));
  CHECK(file.status == 0);
  const auto told = nlohmann::json::parse(file.output);
  CHECK(told["bytes"] == kBox.size());
  CHECK(told["triangles"] == 12);
  CHECK(told["vectors"] == 0);
  CHECK(told["complete"] == true);
  CHECK(told["first_picture_s"].get<double>() >= 0);
  CHECK_FALSE(told.contains("cells"));
  CHECK(run("fetch " + quoted(folder.path("none.wrl"))).status == 1);
  const Run lossy = run("fetch --loss 0.1 http://127.0.0.1:1/a.qnv");
  CHECK(lossy.status == 2);
  CHECK(lossy.output.find("expected a cells: URL") != std::string::npos);

  REQUIRE(run("encode --vectors 200000 " + quoted(world) + " " + quoted(folder.path("box.qnv"))).status == 0);
  ArchiveOptions served;
  served.folder = folder.path("");
  served.cells_port = 0;
  served.log = "";
  auto started = Archive::start(served);
  REQUIRE(std::holds_alternative<std::unique_ptr<Archive>>(started));
  const auto& archive = *std::get<std::unique_ptr<Archive>>(started);
  const std::string url = "cells://127.0.0.1:" + std::to_string(*archive.cells_port()) + "/box.qnv";
  const auto whole = nlohmann::json::parse(run("fetch --json " + quoted(url)).output);
  CHECK(whole["vectors"].get<int>() > 100'000);
  CHECK(whole["cells"]["lost_datagrams"] == 0);
  CHECK(whole["first_picture_bytes"].get<int>() > 0);
  const Run half = run("fetch --json --loss 0.5:3 " + quoted(url));
  CHECK(half.status == 0);
  const auto rest = nlohmann::json::parse(half.output);
  CHECK(rest["cells"]["lost_datagrams"].get<int>() > 0);
  CHECK(rest["vectors"].get<int>() > 100);
  const Run words = run("fetch --rate 20000000 " + quoted(url));
  CHECK(words.output.find("first picture after") != std::string::npos);
  CHECK(words.output.find("granted 20.000 Mbit/s") != std::string::npos);
}

TEST_CASE("snapshot draws, measures, and overwrites pictures only") {
  const ScratchFolder folder;
  const std::string world = folder.write("box.wrl", kBox), out = folder.path("out.png");
  const std::string base = "--backend osmesa --samples 1 --size 64x48 --snapshot " + quoted(out) + " ";
  const Run first = run(base + "--stats " + quoted(folder.path("s.json")) + " " + quoted(world));
  INFO(first.output);
  REQUIRE(first.status == kDone);
  const std::string picture = folder.read("out.png");
  CHECK(picture.starts_with("\x89PNG"));
  const auto stats = nlohmann::json::parse(folder.read("s.json"));
  CHECK(stats["triangles"] == 12);
  CHECK(stats["backend"] == "osmesa");
  CHECK(stats["colors"] >= 2);
  for (const char* key :
       {"bytes", "load_s", "first_image_s", "frame_s", "vectors", "peak_rss_bytes", "splats", "errors", "warnings"})
    CHECK(stats.contains(key));
  double sum = 0;
  for (const char* phase :
       {"read_s", "parse_s", "tessellate_s", "compile_s", "upload_s", "cut_s", "draw_s", "write_s", "other_s"}) {
    INFO(phase);
    REQUIRE(stats.contains(phase));
    const double seconds = stats[phase];
    CHECK(std::isfinite(seconds));
    CHECK(seconds >= 0);
    sum += seconds;
  }
  CHECK(sum == Approx(stats["total_s"].get<double>()));
  // These phases cannot take 0 seconds.
  for (const char* phase : {"parse_s", "tessellate_s", "compile_s", "upload_s", "draw_s", "write_s"})
    CHECK(stats[phase] > 0);
  CHECK(run(base + quoted(world)).status == kDone);
  CHECK(folder.read("out.png") == picture);

  const std::string notes = folder.write("notes", "mine");
  const Run refused = run("--backend osmesa --snapshot " + quoted(notes) + " " + quoted(world));
  CHECK(refused.status == kFailed);
  CHECK(folder.read("notes") == "mine");
  const std::string same = folder.write("world", kBox);
  CHECK(run("--backend osmesa --snapshot " + quoted(same) + " " + quoted(same)).status == kFailed);
  CHECK(folder.read("world") == kBox);
}

TEST_CASE("snapshot ends with one line and status 1 for a file that is no world") {
  const ScratchFolder folder;
  const std::string out = quoted(folder.path("out.png"));
  for (const std::string& file :
       {folder.path("missing.wrl"), folder.write("empty.wrl", ""), folder.write("b.wrl", std::string(64, '\0')),
        folder.write("cut.wrl", kBox.substr(0, 60)), folder.path("")}) {
    const Run result = run("--backend osmesa --size 32x32 --snapshot " + out + " " + quoted(file));
    INFO(file << "\n" << result.output);
    CHECK(result.status == kFailed);
    CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 1);
  }
  CHECK(run("--snapshot " + out + " --viewpoint nowhere --backend osmesa " + quoted(folder.write("box.wrl", kBox)))
            .output.find("no Viewpoint 'nowhere'; the world has none") != std::string::npos);
}

TEST_CASE("snapshot gives up a world in one line that takes too long, and leaves no picture") {
  const ScratchFolder folder;
  // 2^17 coincident boxes that fill the picture: minutes of drawing, below every limit but the time.
  std::string text =
      "#VRML V2.0 utf8\nDEF N0 Shape { appearance Appearance { material Material { transparency 0.5 } } geometry Box { "
      "} }\n";
  for (int i = 1; i <= 17; ++i) {
    const std::string inner = "USE N" + std::to_string(i - 1) + " ";
    text += "DEF N" + std::to_string(i) + " Group { children [ " + inner + inner + "] }\n";
  }
  const Run result = run("--backend osmesa --samples 1 --timeout 1 --snapshot " + quoted(folder.path("out.png")) + " " +
                         quoted(folder.write("boxes.wrl", text)));
  INFO(result.output);
  CHECK(result.status == kFailed);
  CHECK(result.output.find("drawing exceeded --timeout") != std::string::npos);
  CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 1);
  CHECK(folder.read("out.png").empty());
}

TEST_CASE("overwrites measurements by measurements only") {
  const ScratchFolder folder;
  const std::string world = folder.write("box.wrl", kBox), stats = folder.path("s.json");
  CHECK(run("check --stats " + quoted(stats) + " " + quoted(world)).status == kDone);
  CHECK(run("check --stats " + quoted(stats) + " " + quoted(world)).status == kDone);
  const std::string gltf = "{\n  \"asset\": { \"version\": \"2.0\" }\n}\n";
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>{"box.wrl", kBox}, {"model.gltf", gltf}, {"list.json", "[1]"}}) {
    const std::string file = folder.write(name, bytes);
    const Run result = run("check --stats " + quoted(file) + " " + quoted(world));
    INFO(result.output);
    CHECK(result.status == kFailed);
    CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 1);
    CHECK(folder.read(name) == bytes);
  }
}
