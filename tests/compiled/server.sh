#!/bin/sh
# server.sh CC ARGUMENT...: a compiler that leaves a server behind, with whatever files it was given.
sleep 3 </dev/null >/dev/null 2>&1 &
exec "$@"
