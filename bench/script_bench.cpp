// script_bench [SCRIPTS] [STEPS] [PROGRAM]: measures Scripts that answer an event per step: milliseconds to begin,
// milliseconds per step, and KiB per Script in this process. With PROGRAM, a path of ghostspace, they run in its child.

#include "app/script/process/program_process.h"
#include "app/script/script_runner.h"
#include "vrml/syntax/parser.h"

#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

long peak_kib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace gs;
  const int scripts = argc > 1 ? std::atoi(argv[1]) : 1000, steps = argc > 2 ? std::atoi(argv[2]) : 300;
  if (argc > 3) app::script::set_program_of_scripts(argv[3]);
  std::string text = "#VRML V2.0 utf8\nDEF Clock TimeSensor { loop TRUE cycleInterval 2 }\n";
  for (int i = 0; i < scripts; ++i) {
    const std::string n = std::to_string(i);
    text += "DEF T" + n + " Transform {} DEF S" + n + " Script { field SFVec3f place 1 2 3 field SFFloat factor " + n +
            " eventIn SFFloat fraction eventOut SFVec3f moved url \"javascript: function fraction(value, time) {"
            " place.x = value * factor; moved = place.add(new SFVec3f(0, value, 0)); }\" }"
            " ROUTE Clock.fraction_changed TO S" +
            n + ".fraction ROUTE S" + n + ".moved TO T" + n + ".translation\n";
  }
  vrml::SceneGraph scene("bench.wrl");
  Diagnostics diagnostics;
  (void)vrml::parse(text, scene, diagnostics);
  vrml::Execution execution(scene);
  const long before = peak_kib();
  const auto begin = std::chrono::steady_clock::now();
  const auto runner = app::ScriptRunner::make(execution, {0, true});
  if (!runner) return 1;
  execution.scripts().set_host(runner.get());
  execution.start(1000);
  std::printf("%d Scripts: begin %.1f ms, %.1f KiB each\n", scripts, milliseconds_since(begin),
              static_cast<double>(peak_kib() - before) / scripts);
  const auto first = std::chrono::steady_clock::now();
  for (int i = 1; i <= steps; ++i) {
    runner->begin_step();
    execution.step(1000 + i / 60.0);
  }
  std::printf("%.3f ms a step\n", milliseconds_since(first) / steps);
  return 0;
}
