#!/usr/bin/env bash
# tools/deploy against a board that is a folder: ssh, apt-get and systemctl are replaced on the PATH. deploy_test.sh CASE
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fakes=$work/fakes board=$work/board
mkdir -p "$fakes" "$board/etc/touchline" "$board/tmp"
export TOUCHLINE_ROOT=$board TMPDIR=$board/tmp PATH=$fakes:$PATH

fake() { cat >"$fakes/$1"; chmod +x "$fakes/$1"; }
fake ssh <<'END'
#!/bin/bash
while [ $# -gt 0 ]; do
  case $1 in
    -O) exit 0 ;;
    -p) echo "$2" >"$TOUCHLINE_ROOT/port"; shift 2 ;;
    -o) shift 2 ;;
    *) break ;;
  esac
done
[ "$1" = robot@board ] || exit 255
shift
exec sh -c "$*"
END
fake sudo <<'END'
#!/bin/sh
[ "$1" = -n ] && shift
exec "$@"
END
fake dpkg-query <<'END'
#!/bin/sh
[ ! -f "$TOUCHLINE_ROOT/version" ] || echo "installed $(cat "$TOUCHLINE_ROOT/version")"
END
# Versions that begin with 9 cannot be fetched, those with 8 cannot be installed, those with 5 not before the lists are new.
fake apt-get <<'END'
#!/bin/sh
for deb; do :; done
if [ "$1" = update ]; then exec touch "$TOUCHLINE_ROOT/updated"; fi
version=$(dpkg-deb --field "$deb" Version)
case "$version $*" in
  9*--download-only*) exit 100 ;;
  5*--download-only*) [ -f "$TOUCHLINE_ROOT/updated" ] || exit 100; exit 0 ;;
  *--download-only*) exit 0 ;;
  8*) exit 100 ;;
esac
echo "$version" >"$TOUCHLINE_ROOT/version"
END
# Versions that begin with 7 start and never see a frame, those with 6 fail; without a camera all do.
fake systemctl <<'END'
#!/bin/sh
state=$TOUCHLINE_ROOT/state
case $1 in
  start)
    case $(cat "$TOUCHLINE_ROOT/no-camera" "$TOUCHLINE_ROOT/version" 2>/dev/null) in 7*) echo activating ;; 6*) echo failed ;; *) echo active ;; esac >"$state" ;;
  stop) echo inactive >"$state"; [ -f "$TOUCHLINE_ROOT/version" ] || exit 5 ;;
  show) cat "$state" ;;
  enable) touch "$TOUCHLINE_ROOT/enabled" ;;
  *) echo "$1" >>"$TOUCHLINE_ROOT/others" ;;
esac
END
fake journalctl <<'END'
#!/bin/sh
echo "camera: no such device"
END

# package VERSION [ARCH]: prints the path of such a package.
package() {
  local tree=$work/tree deb=$work/touchline_$1.deb
  mkdir -p "$tree/DEBIAN"
  printf 'Package: touchline\nVersion: %s\nArchitecture: %s\nMaintainer: nobody\nDescription: test\n' "$1" "${2:-$(dpkg --print-architecture)}" \
    >"$tree/DEBIAN/control"
  dpkg-deb --build -Znone "$tree" "$deb" >/dev/null
  echo "$deb"
}
# deploy CODE ARGUMENTS...: runs it, and fails unless it ends with that code. Output in $work/said.
deploy() {
  local wanted=$1 code=0
  shift
  "$source_dir/tools/deploy" "$@" >"$work/said" 2>&1 || code=$?
  [ "$code" = "$wanted" ] || fail "exit code $code instead of $wanted"
}
fail() {
  echo "$*; it said:"
  cat "$work/said"
  exit 1
}
says() { grep -qF -- "$1" "$work/said" || fail "does not say '$1'"; }
runs() {
  [ "$(cat "$board/version") $(cat "$board/state")" = "$1 active" ] || fail "version $(cat "$board/version") is $(cat "$board/state") instead of $1"
}

echo "the hall's own" >"$board/etc/touchline/venue.toml"
echo "the old one's" >"$board/etc/touchline/board.toml"
case $1 in
  FirstFrameComes)
    deploy 0 robot@board --port 2222 --deb "$(package 1.0)"
    runs 1.0
    says "first frame within"
    says "keep /etc/touchline"
    [ -f "$board/enabled" ] || fail "not enabled"
    [ "$(cat "$board/port")" = 2222 ] || fail "another port"
    [ ! -e "$board/updated" ] || fail "apt's lists were fetched without need"
    deploy 0 robot@board --deb "$(package 5.0)"
    runs 5.0
    deploy 0 robot@board --deb "$(package 1.1)"
    runs 1.1
    [ "$(cat "$board/etc/touchline/venue.toml")" = "the hall's own" ] || fail "the venue file has changed"
    [ -z "$(ls -A "$board/tmp")" ] || fail "something is left in the board's temporary folder"
    ;;
  WithoutAFrameTheFormerPackageComesBack)
    deploy 0 robot@board --deb "$(package 1.0)"
    mkdir "$work/config"
    echo "the new one's" >"$work/config/board.toml"
    touch "$work/config/team.toml"
    chmod 600 "$work/config/team.toml"
    for bad in 6.0 8.0; do
      deploy 3 robot@board --deb "$(package $bad)" --config "$work/config"
      runs 1.0
      says "going back to 1.0"
      [ "$(cat "$board/etc/touchline/board.toml")" = "the old one's" ] || fail "the new configuration is left behind"
    done
    deploy 0 robot@board --deb "$(package 1.1)" --config "$work/config"
    [ "$(cat "$board/etc/touchline/board.toml")" = "the new one's" ] || fail "the new configuration was not copied"
    [ "$(stat -c %a "$board/etc/touchline/team.toml")" = 644 ] || fail "the service's user cannot read the new configuration"
    [ "$(cat "$board/etc/touchline/venue.toml")" = "the hall's own" ] || fail "the venue file has changed"
    ;;
  WithoutAFrameAndAWayBackItSaysSo)
    deploy 2 robot@board --wait 1 --deb "$(package 7.0)"
    says "camera: no such device"
    says "no earlier package"
    deploy 0 robot@board --deb "$(package 1.0)"
    echo 6 >"$board/no-camera"
    deploy 4 robot@board --deb "$(package 1.1)"
    [ "$(cat "$board/version")" = 1.0 ] || fail "the former package is not back"
    ;;
  WhatCannotBeInstalledChangesNothing)
    deploy 0 robot@board --deb "$(package 1.0)"
    deploy 1 robot@board --deb "$(package 9.0)"
    runs 1.0
    deploy 1 robot@board --deb "$(package 1.1 mips)"
    says "is for mips"
    deploy 1 robot@elsewhere --deb "$(package 1.1)"
    says "does not answer"
    deploy 1 robot@board --deb "$work/none.deb"
    deploy 64 board
    deploy 64 robot@board --wait soon
    deploy 64 robot@board --deb
    runs 1.0
    ;;
  ABrokenConnectionLeavesNothingHalfway)
    deploy 0 robot@board --deb "$(package 1.0)"
    code=0
    sh "$source_dir/toolchain/deploy-on-board" "$(package 6.0)" 1 none >/dev/full 2>&1 || code=$?
    [ "$code" = 3 ] || fail "exit code $code instead of 3 when nobody listens"
    runs 1.0
    # A file that cannot be replaced: a folder has its name.
    mkdir -p "$work/config" "$board/etc/touchline/hall.toml"
    touch "$work/config/hall.toml"
    code=0
    sh "$source_dir/toolchain/deploy-on-board" "$(package 1.1)" 1 "$work/config" >"$work/said" 2>&1 || code=$?
    [ "$code" = 3 ] || fail "exit code $code instead of 3 when the files cannot be replaced"
    runs 1.0
    [ -d "$board/etc/touchline/hall.toml" ] || fail "the former files are not back"
    ;;
  ADryRunChangesNothing)
    deploy 0 robot@board --dry-run --deb "$(package 1.0)"
    says "install 1.0"
    says "dry run"
    [ ! -e "$board/version" ] && [ ! -e "$board/state" ] && [ ! -e "$board/var" ] || fail "something was done"
    ;;
  *) echo "no such case: $1"; exit 1 ;;
esac
