#include "app/commands/options/command_line.h"

int main(int count, char** arguments) { return gs::app::run_command_line(count, arguments); }
