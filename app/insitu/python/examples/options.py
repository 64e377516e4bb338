"""Options that the examples share."""
import argparse


def parse(description, size):
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--size", type=int, default=size, help="points along each axis")
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--every", type=int, default=1, help="take at most each n-th step")
    parser.add_argument("--folder", help="write streams into this folder")
    parser.add_argument("--serve", action="store_true", help="serve the newest step over HTTP")
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--token-file", help="file for the token that changes parameters")
    parser.add_argument("--share", type=float, default=-1.0,
                        help="maximum share of run time for the library; 0 means unlimited")
    parser.add_argument("--error", type=float, default=0.0, help="maximum error of each value")
    parser.add_argument("--mpi", action="store_true", help="use mpi4py")
    return parser.parse_args()


def session_options(options, title):
    result = {"title": title, "serve": options.serve, "port": options.port, "every": options.every,
              "max_share": options.share, "error": options.error}
    if options.folder:
        result["folder"] = options.folder
    if options.token_file:
        result["token_file"] = options.token_file
    return result


def communicator(options):
    """Returns the communicator, the rank and the number of ranks."""
    if not options.mpi:
        return None, 0, 1
    from mpi4py import MPI
    return MPI.COMM_WORLD, MPI.COMM_WORLD.rank, MPI.COMM_WORLD.size
