// Tests of printing: no control of the terminal, and no failure without a message.
#include "app/base/console.h"

#include "app/base/exit_status.h"
#include "tests/app/program.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

using namespace gs::app;

namespace {

const std::string kPrintedWorld = "#VRML V2.0 utf8\nShape { geometry Box { } }\n";
// Text that clears the screen, sets the title, rings the bell and writes "red". It does this again by C1 controls, then
// deletes and reverses text.
const std::string kEvil =
    "\x1b[2J\x1b]0;title\x07\x1b[31mred\xc2\x9b"
    "2J\x7f\xe2\x80\xae\r\xff\xc0\xaf";

bool is_plain(const std::string& output) {
  const bool no_controls = std::all_of(output.begin(), output.end(), [](char c) {
    return c == '\n' || (static_cast<unsigned char>(c) >= 0x20 && c != '\x7f');
  });
  for (unsigned char c = 0x80; c < 0xa0; ++c)
    if (output.find(std::string{'\xc2', static_cast<char>(c)}) != std::string::npos) return false;
  return no_controls && output.find("\xe2\x80\xae") == std::string::npos && output.find('\xff') == std::string::npos &&
         output.find('\xc0') == std::string::npos;
}

// Returns the bytes that a shell line writes to a terminal.
std::string on_terminal(const std::string& line) {
  int terminal = -1;
  const pid_t child = ::forkpty(&terminal, nullptr, nullptr, nullptr);
  REQUIRE(child >= 0);
  if (child == 0) {
    (void)::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
    ::_exit(127);
  }
  std::string output;
  std::array<char, 4096> buffer{};
  for (ssize_t got = 0; (got = ::read(terminal, buffer.data(), buffer.size())) > 0;)
    output.append(buffer.data(), static_cast<std::size_t>(got));
  ::close(terminal);
  REQUIRE(::waitpid(child, nullptr, 0) == child);
  // Terminals add a carriage return to each line end.
  std::erase(output, '\r');
  return output;
}

}  // namespace

TEST_CASE("escapes controls and invalid UTF-8, and keeps printable text") {
  CHECK(printable("plain, with \\ and \"") == "plain, with \\ and \"");
  CHECK(printable("gr\xc3\xbc\xc3\x9f \xe2\x82\xac \xf0\x9f\x91\xbb") ==
        "gr\xc3\xbc\xc3\x9f \xe2\x82\xac \xf0\x9f\x91\xbb");
  CHECK(printable("a\nb\tc\rd") == "a\\nb\\tc\\rd");
  CHECK(printable(std::string("\0\x01\x1b\x7f", 4)) == "\\x00\\x01\\x1b\\x7f");
  CHECK(printable("\xc2\x80\xc2\x9b\xc2\x9f\xc2\xa0") == "\\u0080\\u009b\\u009f\xc2\xa0");
  CHECK(printable("\xe2\x80\xae\xe2\x80\xa8\xe2\x81\xa6\xd8\x9c\xe2\x80\x8f") == "\\u202e\\u2028\\u2066\\u061c\\u200f");
  // Invalid UTF-8: single bytes, truncated, overlong, surrogates, too large.
  const std::pair<const char*, const char*> invalid[] = {
      {"\x80", "\\x80"},
      {"\x9b[2J", "\\x9b[2J"},
      {"\xe2\x82", "\\xe2\\x82"},
      {"\xc3(", "\\xc3("},
      {"\xc0\x9b", "\\xc0\\x9b"},
      {"\xe0\x82\x9b", "\\xe0\\x82\\x9b"},
      {"\xed\xa0\x80", "\\xed\\xa0\\x80"},
      {"\xf4\x90\x80\x80", "\\xf4\\x90\\x80\\x80"},
      {"\xf8\x88\x80\x80\x80", "\\xf8\\x88\\x80\\x80\\x80"},
      {"", ""},
  };
  for (const auto& [bytes, text] : invalid) CHECK(printable(bytes) == text);
}

TEST_CASE("keeps terminal controls out of file names, contents and URLs that it prints") {
  if (int terminal = -1, other = -1; ::openpty(&terminal, &other, nullptr, nullptr, nullptr) == 0) {
    ::close(terminal);
    ::close(other);
  } else {
    WARN("skipped: this machine has no pseudo-terminals");
    return;
  }
  const ScratchFolder folder;
  const std::string evil_name = folder.write("evil" + kEvil + ".wrl", "#VRML V2.0 utf8\nShape { bogus 1 }\n");
  const std::string content = folder.write("content.wrl", "#VRML V2.0 utf8\nWorldInfo { title \"" + kEvil +
                                                              "\" }\nInline { url \"" + kEvil + ".wrl\" }\n" + "DEF a" +
                                                              kEvil + " Group { " + kEvil + " }\nUSE x" + kEvil + "\n");
  const std::string volume =
      folder.write("v.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\nkey:=value " + kEvil +
                                 "\ncontent: " + kEvil + "\n\n12345678");
  const std::string mesh = folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl " + kEvil + "\nmtllib " + kEvil +
                                                     ".mtl\nf 1 2 3\nbogus" + kEvil + "\n");
  for (const std::string& arguments :
       {"check " + quoted(evil_name), "check " + quoted(folder.path("missing" + kEvil)), "check " + quoted(content),
        "info " + quoted(evil_name), "info " + quoted(content), "info " + quoted(volume),
        "info --json " + quoted(volume), "info " + quoted(mesh), "info " + quoted(folder.path("missing" + kEvil)),
        "check " + quoted(mesh), "encode " + quoted(evil_name) + " " + quoted(folder.path("out" + kEvil + ".qnv")),
        "fetch " + quoted(folder.path("missing" + kEvil)), "fetch --json " + quoted(content),
        "check " + quoted("http://127.0.0.1:1/" + kEvil), "--size " + quoted(kEvil) + " a.wrl",
        "--snapshot " + quoted(folder.path("none" + kEvil + "/x.png")) + " --backend osmesa --size 16x16 " +
            quoted(content)}) {
    const Run result = run(arguments);
    INFO(arguments << "\n" << printable(result.output));
    CHECK_FALSE(result.output.empty());
    CHECK(is_plain(result.output));
  }
  // A pipe receives the text of a world unchanged.
  const std::string title = folder.write("title.wrl", "#VRML V2.0 utf8\nWorldInfo { title \"\x1b[2J\" }\n");
  CHECK(run("print " + quoted(title)).output.find("\"\x1b[2J\"") != std::string::npos);
  for (const std::string command : {"print ", "info ", "check "}) {
    const std::string shown = on_terminal(program() + " " + command + quoted(title) + "; echo done");
    INFO(printable(shown));
    CHECK(shown.ends_with("done\n"));
    CHECK(is_plain(shown));
  }
  CHECK(on_terminal(program() + " print " + quoted(title)).find("title \"\\x1b[2J\"") != std::string::npos);
}

TEST_CASE("reports in every command that its output could not be written, and fails") {
  const ScratchFolder folder;
  const std::string world = quoted(folder.write("box.wrl", kPrintedWorld)),
                    bad = quoted(folder.write("bad.wrl", "#VRML V2.0 utf8\nShape { bogus 1 }\n")),
                    out = quoted(folder.path("out.qnv"));
  for (const std::string& arguments :
       {"info " + world, "info --json " + world, "check " + bad, "print " + world, std::string("nodes"),
        std::string("nodes --markdown"), std::string("man"), std::string("--help"), std::string("--version"),
        "fetch " + world, "encode --vectors 100 " + world + " " + out,
        "export " + world + " " + quoted(folder.path("out.ply"))}) {
    const Run full = run_shell(program() + " " + arguments + " > /dev/full");
    INFO(arguments << "\n" << full.output);
    CHECK(full.status == (arguments.starts_with("check") ? kFailed : kNotWritten));
    CHECK(full.output.ends_with("ghostspace: error: cannot write standard output: No space left on device\n"));
    const Run closed = run_shell(program() + " " + arguments + " >&-");
    INFO(closed.output);
    CHECK(closed.status != kDone);
    CHECK(closed.output.find("cannot write standard output") != std::string::npos);
  }
  // `check` prints nothing here, so its output cannot fail.
  CHECK(run_shell(program() + " check " + world + " > /dev/full").status == kDone);
  CHECK(run_shell(program() + " check " + bad + " 2>&- >&- <&-").status == kFailed);
}

TEST_CASE("reports a full disk for every kind of output, and leaves no file") {
  const ScratchFolder folder;
  const std::string world = quoted(folder.write("box.wrl", kPrintedWorld));
  // A file size limit of 0 acts like a full disk, but with another message.
  const std::string picture = "--backend osmesa --samples 1 --size 32x24 --snapshot ";
  for (const std::string& arguments :
       {"encode --vectors 1000 " + world + " " + quoted(folder.path("o.qnv")),
        "encode --outlines " + world + " " + quoted(folder.path("o.wrl")),
        "export " + world + " " + quoted(folder.path("o.ply")), "export " + world + " " + quoted(folder.path("o.glb")),
        picture + quoted(folder.path("o.png")) + " " + world,
        "check --stats " + quoted(folder.path("o.json")) + " " + world}) {
    const Run result =
        run_shell("bash -c " + quoted("ulimit -f 0; exec " + program() + " \"$@\"") + " sh " + arguments);
    INFO(arguments << "\n" << result.output);
    CHECK(result.status == kNotWritten);
    CHECK(result.output.find("File too large") != std::string::npos);
    CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 1);
  }
  for (const char* name : {"o.qnv", "o.wrl", "o.ply", "o.glb", "o.png", "o.json"}) CHECK(folder.read(name).empty());
}

TEST_CASE("ends with one line and a status if memory is too small, never with a crash") {
  if (gs::watched()) return;  // AddressSanitizer reserves terabytes of addresses
  const ScratchFolder folder;
  std::string text = "#VRML V2.0 utf8\n";
  for (int i = 0; i < 120; ++i) text += "Shape { geometry Sphere { radius " + std::to_string(i) + " } }\n";
  const std::string world = quoted(folder.write("spheres.wrl", text));
  std::string raw(std::size_t{24} * 24 * 24, '\0');
  for (std::size_t i = 0; i < raw.size(); ++i) raw[i] = static_cast<char>((i * 2654435761U) >> 13U);
  const std::string volume = quoted(folder.write("v.raw", raw)), stream = quoted(folder.path("o.qnv"));
  int failed = 0, done = 0;
  for (const std::string& arguments :
       {"check " + world, "info " + world, "encode --vectors 4000 " + world + " " + stream,
        "encode --dims 24x24x24 --fraction 0.5 " + volume + " " + stream,
        "export --dims 24x24x24 --isovalue 127 " + volume + " " + quoted(folder.path("o.ply"))})
    for (int megabytes = 100; megabytes <= 400; megabytes += megabytes / 2) {
      const Run result = run_shell("ulimit -v " + std::to_string(megabytes) + "000; " + program() + " " + arguments);
      // The dynamic loader prints its own message.
      if (result.status == 127 || result.output.find("error while loading shared libraries") != std::string::npos)
        continue;
      INFO(megabytes << " MB: " << arguments << "\n" << result.output);
      CHECK((result.status == kDone || result.status == kFailed));
      if (result.status == kFailed) CHECK(result.output.find("memory") != std::string::npos);
      ++(result.status == kFailed ? failed : done);
      if (result.status == kDone) break;  // larger limits succeed too
    }
  CHECK(failed > 0);
  CHECK(done > 0);
}
