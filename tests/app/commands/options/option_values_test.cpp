#include "app/commands/options/option_values.h"

#include "tests/app/program.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

namespace gs::app::option_values_test {

const std::string kBall =
    "#VRML V2.0 utf8\nShape { appearance Appearance { material Material { } } geometry Sphere { } }\n";

TEST_CASE("accepts numbers of bytes and things that end in k, M or G") {
  std::uint64_t number = 0;
  CHECK((read_bytes("400k", number) && number == 400 * 1024));
  CHECK((read_bytes("3M", number) && number == 3 << 20));
  CHECK((read_bytes("2g", number) && number == std::uint64_t{2} << 30));
  CHECK((read_bytes("17", number) && number == 17));
  CHECK((read_count("400k", number) && number == 400'000));
  CHECK((read_count("2M", number) && number == 2'000'000));
  for (const char* bad : {"", "k", "-1", "1.5M", "4kk", "4 k", "k4", "0x10", "99999999999G", "18446744073709551616"})
    CHECK_FALSE(read_bytes(bad, number));
  CHECK((read_bytes("18446744073709551615", number) && number == ~std::uint64_t{0}));
  std::uint16_t small = 0;
  CHECK_FALSE(read_bytes("64k", small));
  CHECK((read_bytes("63k", small) && small == 63 * 1024));
}

TEST_CASE("accepts shares as numbers and as percentages") {
  double share = 0;
  CHECK((read_share("0.25", share) && share == 0.25));
  CHECK((read_share("30%", share) && share == Approx(0.3)));
  CHECK((read_share("100%", share) && share == 1));
  CHECK((read_share("0", share) && share == 0));
  for (const char* bad : {"", "%", "101%", "1.5", "-1%", "30 %", "nan", "x%"}) CHECK_FALSE(read_share(bad, share));
}

TEST_CASE("reads the given number of bytes for --max-bytes 1k") {
  const ScratchFolder folder;
  const std::string text = kBall + "Shape { geometry Cone { } }" + std::string(4000, ' ') + "Nonsense { }\n";
  const std::string file = folder.write("a.wrl", text);
  CHECK(run("check --max-bytes 1k " + quoted(file)).output.empty());
  CHECK(run("check --max-bytes 5K " + quoted(file)).output.find("Nonsense") != std::string::npos);
  CHECK(run("check --max-bytes some " + quoted(file)).output.find("400k") != std::string::npos);
}

TEST_CASE("reads standard input for -, from a file or a pipe, once, for inputs only") {
  const ScratchFolder folder;
  const std::string file = folder.write("a.wrl", kBall);
  const Run redirected = run("print - < " + quoted(file));
  CHECK(redirected.status == 0);
  CHECK(redirected.output.find("geometry Sphere") != std::string::npos);
  const Run piped = run_shell("cat " + quoted(file) + " | " + program() + " print -");
  CHECK(piped.output == redirected.output);
  const Run wrong = run_shell("echo 'Nonsense { }' | " + program() + " check -");
  CHECK(wrong.status == 1);
  CHECK(wrong.output.starts_with("/dev/stdin:1:1: error"));
  CHECK(run("check - - < " + quoted(file)).output.find("once") != std::string::npos);
  // References of a text are relative to the start folder of the program.
  folder.write("outer.wrl", "#VRML V2.0 utf8\nInline { url \"a.wrl\" }\n");
  const Run outer = run_shell("cd " + quoted(folder.path("")) + " && cat outer.wrl | " + program() + " check -");
  INFO(outer.output);
  CHECK(outer.status == 0);
  CHECK(outer.output.empty());
  const Run large = run_shell("head -c 20000000 /dev/zero | " + program() + " check --memory 16M -");
  CHECK(large.status == 1);
  CHECK(large.output.find("--memory") != std::string::npos);
}

TEST_CASE("reports a word that is neither file nor command as wrong usage, without a window") {
  const Run result = run("frobnicate");
  CHECK(result.status == 2);
  CHECK(result.output.starts_with("ghostspace: frobnicate: not a file or command"));
  CHECK(result.output.find("serve") != std::string::npos);
  const ScratchFolder folder;
  folder.write("frobnicate", kBall);
  const Run file = run_shell("cd " + quoted(folder.path("")) + " && " + program() +
                             " --backend osmesa --size 32x32 --snapshot o.png frobnicate");
  INFO(file.output);
  CHECK(file.status == 0);
}

TEST_CASE("draws the demo world if no file is given") {
  const ScratchFolder folder;
  const Run result = run("--backend osmesa --size 32x24 --snapshot " + quoted(folder.path("o.png")));
  INFO(result.output);
  CHECK(result.status == 0);
  CHECK(folder.read("o.png").starts_with("\x89PNG"));
}

TEST_CASE("refuses picture formats other than PNG before drawing, and names the formats") {
  const ScratchFolder folder;
  const std::string file = folder.write("a.wrl", kBall);
  for (const char* name : {"o.foo", "o.jpg", "o.tar.gz", "o.png.bak"}) {
    const Run result = run("--backend osmesa --size 8x8 --snapshot " + quoted(folder.path(name)) + " " + quoted(file));
    CHECK(result.status == 2);
    CHECK(result.output.find("expected a name that ends in .png") != std::string::npos);
    CHECK(folder.read(name).empty());
  }
  for (const char* name : {"o.PNG", "thumbnail"})
    CHECK(run("--backend osmesa --size 8x8 --snapshot " + quoted(folder.path(name)) + " " + quoted(file)).status == 0);
}

TEST_CASE("serve reports a missing folder") {
  const ScratchFolder folder;
  const Run missing = run("serve --http 0 " + quoted(folder.path("nothing")));
  CHECK(missing.status == 1);
  CHECK(missing.output.find("nothing: no such folder") != std::string::npos);
  CHECK(missing.output.find("cache") == std::string::npos);
  const Run file = run("serve --http 0 " + quoted(folder.write("a.wrl", kBall)));
  CHECK(file.output.find("not a folder") != std::string::npos);
}

}  // namespace gs::app::option_values_test
