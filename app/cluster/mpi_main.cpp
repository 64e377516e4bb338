#include "app/base/console.h"
#include "app/base/exit_status.h"
#include "app/cluster/mpi_team.h"
#include "app/commands/options/command_line.h"

#include <string_view>

// ghostspace-mpi: runs the command `encode` in the processes that mpirun started.
int main(int count, char** arguments) {
  if (gs::app::is_child_call(count, arguments)) return gs::app::run_command_line(count, arguments);
  const std::string_view word = count > 1 ? arguments[1] : "";
  gs::app::MpiTeam team(&count, &arguments);
  gs::app::set_encode_team(&team);
  int status = gs::app::kUsage;
  if (word == "encode" || word == "--help" || word == "--version")
    status = gs::app::run_command_line(count, arguments);
  else
    gs::app::complain("ghostspace-mpi: expected 'encode IN... OUT.qnv' and options; see 'ghostspace encode --help'");
  // All processes have the same command line, so all of them reject it.
  if (status == gs::app::kUsage || word != "encode") team.end_together();
  gs::app::set_encode_team(nullptr);
  return status;
}
