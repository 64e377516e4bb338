#include "tests/app/insitu/insitu_helpers.h"
#include "tests/app/run_program.h"

#include <cmath>
#include <filesystem>

namespace gs::app::insitu {
namespace insitu_examples_test {

using namespace test;

/// Heat equation as in the examples, on one rank.
std::vector<double> heat_after(int n, int steps) {
  const auto at = [n](int x, int y, int z) { return static_cast<std::size_t>((z * n + y) * n + x); };
  std::vector<double> u(static_cast<std::size_t>(n * n * n)), next(u.size());
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const double dx = static_cast<double>(x) / n - 0.35, dy = static_cast<double>(y) / n - 0.5,
                     dz = static_cast<double>(z) / n - 0.5, ex = static_cast<double>(x) / n - 0.7,
                     ey = static_cast<double>(y) / n - 0.6;
        u[at(x, y, z)] =
            100 * std::exp(-60 * (dx * dx + dy * dy + dz * dz)) + 80 * std::exp(-150 * (ex * ex + ey * ey + dz * dz));
      }
  for (int step = 0; step < steps; ++step) {
    for (int z = 1; z + 1 < n; ++z)
      for (int y = 1; y + 1 < n; ++y)
        for (int x = 1; x + 1 < n; ++x)
          next[at(x, y, z)] = u[at(x, y, z)] +
                              0.1 * (u[at(x - 1, y, z)] + u[at(x + 1, y, z)] + u[at(x, y - 1, z)] + u[at(x, y + 1, z)] +
                                     u[at(x, y, z - 1)] + u[at(x, y, z + 1)] - 6 * u[at(x, y, z)]);
    u.swap(next);
  }
  return u;
}

// Returns the command of an example, or "" with a message if it was not built.
std::string example_program(const std::string& name) {
  const std::string path = std::string(GHOSTSPACE_EXAMPLES) + "/insitu_" + name;
  if (std::filesystem::exists(path)) return path;
  WARN(path << " was not built; the test is skipped");
  return {};
}

bool succeeds(const std::string& line) { return run_shell(line + " >/dev/null 2>&1").status == 0; }

// Returns the command that runs a program under MPI with 3 ranks, or "" with a message.
std::string under_mpi(const std::string& line) {
  const std::string start =
      "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_btl_vader_single_copy_mechanism=none "
      "mpirun --oversubscribe -n 3 ";
  if (succeeds(start + "true")) return start + line;
  WARN("mpirun is missing or cannot start; the test is skipped");
  return {};
}

// Returns the command of a Python with some modules and with the library, or "" with a message.
std::string python_with(const std::string& modules) {
  const std::string folder = std::string(GHOSTSPACE_TESTS) + "/../app/insitu/python";
  if (std::filesystem::exists(GHOSTSPACE_INSITU))
    for (const std::string python : {"python3", "/usr/bin/python3"})
      if (succeeds(python + " -c 'import " + modules + "'"))
        return "env PYTHONDONTWRITEBYTECODE=1 GHOSTSPACE_INSITU_LIBRARY=" GHOSTSPACE_INSITU " PYTHONPATH=" + folder +
               " " + python + " ";
  WARN("the library, Python or one of its modules (" << modules << ") is missing; the test is skipped");
  return {};
}

// Returns the command of an example in Python, or "" with a message if a module is missing.
std::string python_example(const std::string& name, const std::string& modules) {
  const std::string python = python_with(modules);
  if (python.empty()) return {};
  return python + GHOSTSPACE_TESTS + "/../app/insitu/python/examples/" + name + ".py";
}

// Runs the heat equation for a few steps, and compares its streams with the values.
void check_heat(const std::string& line, bool second_source) {
  if (line.empty()) return;
  const ScratchFolder scratch;
  const Run done = run_shell(line + " --size 20 --steps 11 --every 5 --error 0.01 --folder " + scratch.path("out"));
  INFO(done.output);
  REQUIRE(done.status == 0);
  for (const int step : {0, 5, 10}) {
    char name[64];
    std::snprintf(name, sizeof name, "out/temperature.%06d.qnv", step);
    const DecodedVolume decoded = decoded_volume(scratch.read(name));
    REQUIRE(decoded.size == std::array<std::uint32_t, 3>{20, 20, 20});
    CHECK(decoded.error <= 0.01);
    if (!second_source) continue;
    const std::vector<double> expected = heat_after(20, step);
    double most = 0;
    for (std::size_t i = 0; i < expected.size(); ++i)
      most = std::max(most, std::abs(expected[i] - static_cast<double>(decoded.values[i])));
    CHECK(most <= 0.01);
  }
}

TEST_CASE("in situ examples: the heat equation in C writes its values", "[optimised]") {
  check_heat(example_program("heat"), true);
}

TEST_CASE("in situ examples: the heat equation under MPI writes the same values", "[optimised]") {
  const std::string program = example_program("heat_mpi");
  if (!program.empty()) check_heat(under_mpi(program), true);
}

TEST_CASE("in situ examples: the heat equation in Python writes its values", "[optimised]") {
  check_heat(python_example("heat", "numpy"), false);
}

TEST_CASE("in situ examples: the heat equation in Python runs under MPI", "[optimised]") {
  const std::string line = python_example("heat", "numpy, mpi4py");
  if (!line.empty()) check_heat(under_mpi(line + " --mpi"), false);
}

TEST_CASE("in situ examples: the Gray-Scott reaction writes both substances in C and in Python", "[optimised]") {
  for (const std::string& line : {example_program("gray_scott"), python_example("gray_scott", "numpy")}) {
    if (line.empty()) continue;
    const ScratchFolder scratch;
    const Run done = run_shell(line + " --size 16 --steps 3 --folder " + scratch.path("out"));
    INFO(done.output);
    REQUIRE(done.status == 0);
    const DecodedVolume first = decoded_volume(scratch.read("out/V.000000.qnv"));
    // V is 0.25 in the middle at first, and 0 at the corners.
    CHECK(first.values[(std::size_t{8} * 16 + 8) * 16 + 8] == Approx(0.25).margin(first.error));
    CHECK(first.values[0] == Approx(0).margin(first.error));
    const DecodedVolume last = decoded_volume(scratch.read("out/U.000002.qnv"));
    CHECK(last.values[0] == Approx(1).margin(last.error));
    CHECK(last.values[(std::size_t{8} * 16 + 8) * 16 + 8] < 0.9);
  }
}

TEST_CASE("in situ examples: particles in C and in Python are on their circles", "[optimised]") {
  for (const std::string& line : {example_program("particles"), python_example("particles", "array")}) {
    if (line.empty()) continue;
    const ScratchFolder scratch;
    const Run done = run_shell(line + " --size 8 --steps 2 --folder " + scratch.path("out"));
    INFO(done.output);
    REQUIRE(done.status == 0);
    const std::vector<std::byte> bytes = bytes_of_text(scratch.read("out/speed-particles.000001.qnv"));
    const qnv::DecodedStream decoded = qnv::decode_stream(bytes, 1 << 20);
    const auto* geometry = std::get_if<qnv::Geometry>(&decoded.content);
    REQUIRE(geometry);
    const auto* splats = geometry->as<qnv::Gaussians>();
    REQUIRE(splats);
    CHECK(splats->size() == 512);
    for (const glm::vec3& at : splats->positions) {
      const double radius = std::hypot(static_cast<double>(at.x), static_cast<double>(at.z));
      CHECK(radius >= 0.28);
      CHECK(radius <= 3.32);
      CHECK(std::abs(at.y) <= 0.22f);
    }
  }
}

TEST_CASE("in situ examples: the viewer shows the world of a run", "[optimised]") {
  const std::string program = example_program("heat");
  if (program.empty()) return;
  const ScratchFolder scratch;
  REQUIRE(succeeds(program + " --size 24 --steps 1 --folder " + scratch.path("out")));
  const Run shown = run("--snapshot " + scratch.path("a.png") + " --size 160x120 " + scratch.path("out/live.wrl"));
  INFO(shown.output);
  CHECK(shown.status == 0);
  CHECK(std::filesystem::file_size(scratch.path("a.png")) > 1500);
}

TEST_CASE("in situ examples: ParaView's Catalyst example writes its values through the adaptor", "[optimised]") {
  const std::string python = python_with("numpy, paraview.modules.vtkPVPythonCatalyst");
  if (python.empty()) return;
  const ScratchFolder scratch;
  const Run done = run_shell("GHOSTSPACE_CATALYST='serve=0 error=0.01 every=2 folder=" + scratch.path("out") + "' " +
                             python + "-m paraview.demos.wavelet_miniapp --size 21 -t 3 -s " + GHOSTSPACE_TESTS +
                             "/../app/insitu/python/ghostspace_insitu/catalyst.py");
  INFO(done.output);
  REQUIRE(done.status == 0);
  const DecodedVolume decoded = decoded_volume(scratch.read("out/RTData.000000.qnv"));
  REQUIRE(decoded.size == std::array<std::uint32_t, 3>{21, 21, 21});
  // vtkRTAnalyticSource: maximum + 5 cos(0) in the middle.
  CHECK(decoded.values[(std::size_t{10} * 21 + 10) * 21 + 10] == Approx(260).margin(0.01));
  CHECK(decoded.layout.origin.x == -10);
  CHECK(std::filesystem::exists(scratch.path("out/RTData.000002.qnv")));
  CHECK_FALSE(std::filesystem::exists(scratch.path("out/RTData.000001.qnv")));
}

TEST_CASE("in situ library: only its own functions are visible, and it needs no window", "[optimised]") {
  if (!std::filesystem::exists(GHOSTSPACE_INSITU) || !succeeds("nm --version")) {
    WARN("the library or nm is missing; the test is skipped");
    return;
  }
  const Run symbols =
      run_shell("nm -D --defined-only " GHOSTSPACE_INSITU " | grep -v ' A ' | grep -vc ' T gs_insitu_'");
  CHECK(symbols.output == "0\n");
  const Run needed = run_shell("readelf -d " GHOSTSPACE_INSITU);
  CHECK(needed.output.find("[libghostspace-insitu.so.1]") != std::string::npos);
  for (const char* library : {"libGL", "libOpenGL", "libglfw", "libmozjs", "libX11", "libfreetype"})
    CHECK(needed.output.find(library) == std::string::npos);
}

}  // namespace insitu_examples_test
}  // namespace gs::app::insitu
