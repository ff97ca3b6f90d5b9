#include "tools/programs/simulate/serve_command.h"

#include <cstdio>

#include "tools/programs/command_line/command_line.h"
#include "tools/programs/simulate/lockstep_server.h"

namespace touchline::simulate {

CLI::App* add_serve_command(CLI::App& app, ServeOptions& options) {
  CLI::App* const command = app.add_subcommand(
      "serve",
      "Let a program outside own the time of games without pictures: it answers each frame before the time goes\n"
      "on (docs/arena.md, \"Lock-step\"). The first program that connects resets and steps the game; a second one\n"
      "can drive the opponents. Ends when the first one closes its connection");
  command->add_option("--board", options.board, "Board file of the arena")->type_name("FILE")->capture_default_str();
  command->add_option("--listen", options.listen, "Where programs connect: unix:///PATH or tcp://ADDRESS:PORT")
      ->type_name("ADDRESS")
      ->capture_default_str();
  command
      ->add_option("--silence", options.silence_s,
                   "End the game with an error if a program is silent for this long, in s; 0: never")
      ->check(number_range(0.0, 86400.0))
      ->capture_default_str();
  add_overrides(*command, options.overrides, "the three files");
  add_examples(*command, {{"touchline-simulate serve --listen unix:///tmp/game", "wait for a program at this socket"}});
  return command;
}

Result<void> run_serve(const ServeOptions& options) {
  TOUCHLINE_TRY_ASSIGN(const StreamAddress address, parse_stream_address(options.listen));
  LockstepGame game(options.board, options.overrides);
  LockstepServer server(game, options.silence_s);
  TOUCHLINE_TRY(server.open(address));
  std::printf("waiting for a program at %s\n", server.address().c_str());
  std::fflush(stdout);
  return server.serve();
}

}  // namespace touchline::simulate
