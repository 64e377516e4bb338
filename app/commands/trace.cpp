#include "app/commands/trace.h"

#include "app/base/console.h"
#include "app/commands/common/shared.h"
#include "app/loading/world_loader.h"
#include "app/loading/world_loading.h"
#include "app/media/wave_file.h"
#include "app/session/opening/links.h"
#include "app/simulation/simulation.h"
#include "net/files/file.h"
#include "vrml/syntax/printer.h"

#include <charconv>
#include <cstdlib>
#include <cstring>
#include <span>
#include <utility>

namespace gs::app {

std::optional<std::string> check_trace(const TraceCommand& options) {
  if (options.paper) return "expected a --size in pixels";
  return options.until ? std::optional<std::string>() : "expected --until SECONDS";
}

bool plan_input(const SimulationOptions& options, Simulation& simulation) {
  if (options.press_sensors) simulation.press_sensors();
  if (options.input.empty()) return true;
  const auto opened = net::map_file(options.input);
  if (const auto* problem = std::get_if<net::FileError>(&opened)) {
    (void)fail(problem->message);
    return false;
  }
  const auto bytes = std::get<net::MappedFile>(opened).bytes();
  Diagnostics diagnostics;
  const auto rows =
      read_input_rows({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, options.input, diagnostics);
  (void)simulation.plan(rows, options.input, diagnostics);
  print_diagnostics(diagnostics);
  return diagnostics.errors() == 0;
}

void use_universal_time() { (void)::setenv("TZ", "UTC", 1); }

void tell_of_programs(Simulation& simulation, Diagnostics& told) {
  simulation.observe_scripts([&told](const ScriptMessage& message) {
    if (message.printed) return;
    const std::size_t stored = told.entries().size();
    told.add(message.diagnostic);
    if (told.entries().size() > stored) complain("%s", message.diagnostic.text().c_str());
  });
}

void tell_of_simulation(const SimulationOptions& options, const std::string& path, Simulation& simulation) {
  const char* const file = path.c_str();
  print_diagnostics(simulation.troubles());
  if (options.press_sensors) {
    const SensorTour::Counts counts = simulation.pressed_sensors();
    complain("%s: note: %zu of %zu sensors and Anchors pressed, %zu of %zu ProximitySensors visited", file,
             counts.pressed, counts.sensors, counts.visited, counts.places);
  }
  if (const std::string& problem = simulation.execution().budget().problem(); !problem.empty())
    complain("%s: warning: %s", file, problem.c_str());
}

// Writes the sound. Replaces only sound files, so that a wrong FILE.wav does not destroy a world.
int write_sound(const SimulationOptions& options, const WaveFile& sound) {
  if (options.sound.empty()) return kDone;
  const auto opened = net::map_file(options.sound);
  if (const auto* file = std::get_if<net::MappedFile>(&opened)) {
    const auto there = file->bytes();
    constexpr char kWave[] = {'R', 'I', 'F', 'F'};
    if (!there.empty() && (there.size() < sizeof kWave || std::memcmp(there.data(), kWave, sizeof kWave) != 0))
      return fail(options.sound + " already exists and is not a WAV file; not overwritten");
  }
  if (const auto problem = net::write_file_atomically(options.sound, sound.bytes()))
    return fail_to_write(options.sound + ": " + problem->message);
  return kDone;
}

int run_trace(const TraceCommand& options) {
  use_universal_time();
  const GivenPlace given = given_place(options.files.front());
  if (!given.problem.empty()) return fail(given.target + ": " + given.problem);
  WorldLoading loading(given.target, load_options(options));
  LoadedWorld world = load_world(loading, given.target);
  print_diagnostics(world.diagnostics);
  if (!world.scene) return kFailed;
  Simulation simulation(std::move(world), {options.width, options.height});
  simulation.fetch_with(loading);
  if (!given.viewpoint.empty())
    if (const auto problem = simulation.begin_at(given.viewpoint))
      complain("%s: warning: %s", given.target.c_str(), problem->c_str());
  if (!plan_input(options, simulation)) return kFailed;
  vrml::NodeNames names(*simulation.world().scene);
  std::string line;
  simulation.execution().cascade().observe([&](const vrml::SentEvent& event) {
    char digits[64];
    line.assign(digits, std::to_chars(digits, digits + sizeof digits, event.time).ptr);
    line += ' ' + names.of(*event.scene, event.node) + '.' + event.event->name;
    if (event.event->access == vrml::AccessType::exposedField) line += "_changed";  // VRML97 4.7
    line += ' ';
    vrml::print_value(line, *event.value, *event.scene);
    line += '\n';
    print_text(line);
  });
  simulation.observe_scripts([&](const ScriptMessage& message) {
    if (message.printed) {
      char digits[64];
      *std::to_chars(digits, digits + sizeof digits - 1, simulation.execution().now()).ptr = '\0';
      print_line("%s print %s", digits, message.diagnostic.message.c_str());
    } else {
      complain("%s", message.diagnostic.text().c_str());
    }
  });
  WaveFile sound;
  if (!options.sound.empty()) simulation.hear([&](std::span<const float> pairs) { sound.add(pairs); });
  simulation.run(*options.until, [] { return !output_failed(); });
  if (const int status = write_sound(options, sound); status != kDone) return status;
  tell_of_simulation(options, options.files.front(), simulation);
  return simulation.world().truncated ? kFailed : kDone;
}

}  // namespace gs::app
