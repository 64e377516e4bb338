#include "app/encode/encode_team.h"

namespace gs::app {
namespace {

EncodeTeam* team_of_process = nullptr;

}  // namespace

void set_encode_team(EncodeTeam* team) { team_of_process = team; }
EncodeTeam* encode_team() { return team_of_process; }

}  // namespace gs::app
