#pragma once

#include "app/script/boundary/world_access.h"
#include "vrml/event_model/behaviour.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>

// Orders of a world to its programs.
namespace gs::app::script {

/// Message of a program that exceeds its time.
inline constexpr char kLateProgram[] = "the program exceeded the time limit";
/// Number of faults that switch a program off.
inline constexpr int kMaxFaults = 3;

/// Script and the rights of its program. Its world decides all of this.
struct ProgramFacts {
  NodeRef node;
  std::shared_ptr<const vrml::NodeType> type;        // of the Script
  vrml::Language language = vrml::Language::vrml97;  // of the text of the Script: selects the API
  std::string library;       // key of the group of programs that share library objects (read_rule.h)
  std::string late_message;  // see ScriptRunner::on_overdue()
  int faults = 0;            // of earlier programs of the Script
};

/// Reports whether every Script has this declaration. It is then not a name in the program.
[[nodiscard]] bool is_own_field_of_script(vrml::Language language, const vrml::InterfaceDeclaration& declaration);

struct Order {
  enum class Kind : std::uint8_t {
    start,     // facts, text, file, at: compile a program and run it
    event,     // place, value, time: call the function of an eventIn
    call,      // text: call a function without arguments, if it exists
    end,       // call shutdown()
    forget,    // discard the program
    evaluate,  // text: run a line of code
    check,     // text, file, at: compile a program without running it
  };
  Kind kind = Kind::event;
  vrml::EventNode program = 0;
  std::uint32_t place = 0;
  vrml::FieldValue value{};
  double time = 0;
  std::string text{}, file{};
  SourceLocation at{};
  std::shared_ptr<const ProgramFacts> facts{};
  /// Values of fields and eventOuts that the programs do not know yet, with their places.
  std::vector<std::pair<std::uint32_t, vrml::FieldValue>> values{};
  std::vector<std::uint64_t> gone{};  // scenes that are no longer part of the world
  double now = 0;                     // time of the world
  double seconds = 0;                 // limits of the call
  std::size_t heap = 0, image_pixels = 0;
};
inline constexpr int kOrderCount = static_cast<int>(Order::Kind::check) + 1;

struct Report {
  bool good = false;       // start: the text was compiled; evaluate: the line has a value; check: no problem
  bool no_memory = false;  // there is too little memory for programs
  bool runs = false, off = false, has_processed = false, has_prepare = false;  // state of the program
  bool skipped = false;  // the order was not run, because those before it took long
  double seconds = 0;    // duration of the call
  int faults = 0;
  std::string text{};
  std::optional<Diagnostic> problem{};
};

/// Programs of one world. One thread.
class ProgramHost : NonCopyable {
 public:
  virtual ~ProgramHost() = default;
  [[nodiscard]] virtual Report run(const Order& order) = 0;
  /// Receiver of the report of each order. What programs ask and tell afterwards belongs to the next order. Returns
  /// false if the next order should not run.
  using Reported = std::function<bool(const Report&)>;
  /// Runs orders one after the other: at least the first, and fewer than all if they take long or if programs stop.
  virtual void run_all(std::span<const Order> orders, const Reported& reported) {
    for (const Order& order : orders)
      if (!reported(run(order))) return;
  }
  /// Returns the number of orders of run_all() between the last one with a report and the one that stopped the
  /// programs.
  [[nodiscard]] virtual std::size_t unreported() const { return 0; }
  /// Returns why no program runs any more; empty while programs run.
  [[nodiscard]] virtual std::string stopped() const { return {}; }
};

/// Makes a host that runs programs in this process. Returns null if there is too little memory for SpiderMonkey. If
/// `repeatable`, Math.random has a fixed sequence, and Date returns the time of the world.
[[nodiscard]] std::unique_ptr<ProgramHost> make_programs(WorldAccess& world, bool repeatable);

}  // namespace gs::app::script
