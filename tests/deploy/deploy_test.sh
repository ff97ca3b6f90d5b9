#!/usr/bin/env bash
# Tests tools/deploy with a folder as board: fakes on the PATH replace apt-get, systemctl, sudo and, except in
# WorksOverARealSshConnection, ssh. deploy_test.sh CASE [SSHD]
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fakes=$work/fakes board=$work/board own_arch=$(dpkg --print-architecture)
mkdir -p "$fakes" "$board/etc/touchline" "$board/tmp"
export TOUCHLINE_ROOT=$board TOUCHLINE_STEADY_S=0 TMPDIR=$board/tmp PATH=$fakes:$PATH

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
fake dpkg <<'END'
#!/bin/sh
cat "$TOUCHLINE_ROOT/arch"
END
# The user is not root on the board, even if root runs the test.
fake id <<'END'
#!/bin/sh
echo 1000
END
# If there is a file "password", sudo requires the password in it.
fake sudo <<'END'
#!/bin/sh
password=$TOUCHLINE_ROOT/password
if [ "$1" = -n ]; then
  shift
  [ ! -f "$password" ] || { echo "sudo: a password is required" >&2; exit 1; }
elif [ "$1 $2 $3" = "-S -p " ]; then
  shift 3
  IFS= read -r line && [ "$line" = "$(cat "$password")" ] || exit 1
fi
exec "$@"
END
fake dpkg-query <<'END'
#!/bin/sh
for pattern; do :; done
case $pattern in
  libcamera*) cat "$TOUCHLINE_ROOT/libcamera" 2>/dev/null ;;
  touchline-tools) [ -f "$TOUCHLINE_ROOT/tools" ] && printf '%s\n' "$3" | sed "s/.{db:Status-Status}/installed/; s/.{Version}/$(cat "$TOUCHLINE_ROOT/tools")/; s/.n$//" ;;
  *) [ -f "$TOUCHLINE_ROOT/version" ] && printf '%s\n' "$3" | sed "s/.{db:Status-Status}/installed/; s/.{Version}/$(cat "$TOUCHLINE_ROOT/version")/; s/.n$//" ;;
esac
END
# Versions that begin with 9 cannot be downloaded, with 8 cannot be installed, with 5 cannot be downloaded before apt-get update. The
# system's updates are always in progress: a call that does not wait for the lock fails.
fake apt-get <<'END'
#!/bin/sh
for deb; do :; done
if [ "$1" = update ]; then exec touch "$TOUCHLINE_ROOT/updated"; fi
version=$(dpkg-deb --field "$deb" Version)
case "$*" in *DPkg::Lock::Timeout=*) ;; *) exit 100 ;; esac
case "$version $*" in
  9*--download-only*) exit 100 ;;
  5*--download-only*) [ -f "$TOUCHLINE_ROOT/updated" ] || exit 100; exit 0 ;;
  *--download-only*) exit 0 ;;
  8*) exit 100 ;;
esac
echo "$version" >"$TOUCHLINE_ROOT/version"
# touchline-tools needs the same version, and is removed otherwise.
case "$*" in
  *-tools.deb*) echo "$version" >"$TOUCHLINE_ROOT/tools" ;;
  *) rm -f "$TOUCHLINE_ROOT/tools" ;;
esac
END
# Versions that begin with 7 start but get no frame; with 6 fail; with 4 fail after their first frame. Without a camera all fail.
fake systemctl <<'END'
#!/bin/sh
state=$TOUCHLINE_ROOT/state
case $1 in
  start)
    case $(cat "$TOUCHLINE_ROOT/no-camera" "$TOUCHLINE_ROOT/version" 2>/dev/null) in 7*) echo activating ;; 6*) echo failed ;; *) echo active ;; esac >"$state" ;;
  stop) echo inactive >"$state"; [ -f "$TOUCHLINE_ROOT/version" ] || exit 5 ;;
  show)
    cat "$state"
    case $(cat "$TOUCHLINE_ROOT/version" "$state") in 4*active) echo activating >"$state" ;; esac ;;
  enable) touch "$TOUCHLINE_ROOT/enabled" ;;
  *) echo "$1" >>"$TOUCHLINE_ROOT/others" ;;
esac
END
fake journalctl <<'END'
#!/bin/sh
echo "camera: no such device"
END

# package VERSION [ARCH [DEPENDS]]: makes a package and prints its path.
package() {
  local tree=$work/tree deb=$work/touchline_$1.deb
  mkdir -p "$tree/DEBIAN"
  printf 'Package: touchline\nVersion: %s\nArchitecture: %s\nDepends: %s\nMaintainer: nobody\nDescription: test\n' "$1" "${2:-$own_arch}" \
    "${3:-libc6}" \
    >"$tree/DEBIAN/control"
  dpkg-deb --build -Znone "$tree" "$deb" >/dev/null
  echo "$deb"
}
# deploy CODE ARGUMENTS...: runs tools/deploy and fails unless it exits with CODE. The output is in $work/output.
deploy() {
  local wanted=$1 code=0
  shift
  "$source_dir/tools/deploy" "$@" >"$work/output" 2>&1 || code=$?
  [ "$code" = "$wanted" ] || fail "exit code $code instead of $wanted"
}
fail() {
  echo "$*; output:"
  cat "$work/output"
  exit 1
}
says() { grep -qF -- "$1" "$work/output" || fail "does not say '$1'"; }
runs() {
  [ "$(cat "$board/version") $(cat "$board/state")" = "$1 active" ] || fail "version $(cat "$board/version") is $(cat "$board/state") instead of $1"
}

echo "$own_arch" >"$board/arch"
echo VERSION_CODENAME=bookworm >"$board/etc/os-release"
echo "the hall's own" >"$board/etc/touchline/venue.toml"
echo "the old one's" >"$board/etc/touchline/board.toml"
case $1 in
  AFirstFrameCompletesTheDeployment)
    deploy 0 robot@board --port 2222 --deb "$(package 1.0)"
    runs 1.0
    says "first frame within"
    says "keep /etc/touchline"
    [ -f "$board/enabled" ] || fail "not enabled"
    [ "$(cat "$board/port")" = 2222 ] || fail "ssh used another port"
    [ ! -e "$board/updated" ] || fail "apt's lists were fetched without need"
    deploy 0 robot@board --deb "$(package 5.0)"
    runs 5.0
    deploy 0 robot@board --deb "$(package 1.1)"
    runs 1.1
    [ "$(cat "$board/etc/touchline/venue.toml")" = "the hall's own" ] || fail "the venue file has changed"
    [ -z "$(ls -A "$board/tmp")" ] || fail "files are left in the board's temporary folder"
    ;;
  ToolsOnTheBoardKeepTheVersionOfTheirPackage)
    deploy 0 robot@board --deb "$(package 1.0)"
    [ ! -e "$board/tools" ] || fail "tools came to a board without them"
    echo 1.0 >"$board/tools"
    cp "$work/touchline_1.0.deb" "$work/touchline-tools_1.0.deb"
    deploy 0 robot@board --deb "$work/touchline_1.0.deb"
    cp "$(package 1.1)" "$work/touchline-tools_1.1.deb"
    deploy 0 robot@board --deb "$work/touchline_1.1.deb"
    [ "$(cat "$board/tools")" = 1.1 ] || fail "tools are of version $(cat "$board/tools")"
    # The former version returns with its tools.
    cp "$(package 6.0)" "$work/touchline-tools_6.0.deb"
    deploy 3 robot@board --deb "$work/touchline_6.0.deb"
    runs 1.1
    [ "$(cat "$board/tools")" = 1.1 ] || fail "tools are of version $(cat "$board/tools") after a failure"
    deploy 0 robot@board --deb "$(package 1.2)"
    says "touchline-tools 1.1 was removed"
    ;;
  WithoutAFrameTheFormerPackageIsRestored)
    deploy 0 robot@board --deb "$(package 1.0)"
    mkdir "$work/config"
    echo "the new one's" >"$work/config/board.toml"
    touch "$work/config/team.toml"
    chmod 600 "$work/config/team.toml"
    for bad in 6.0 8.0; do
      deploy 3 robot@board --deb "$(package $bad)" --config "$work/config"
      runs 1.0
      says "restoring version 1.0"
      [ "$(cat "$board/etc/touchline/board.toml")" = "the old one's" ] || fail "the new configuration is left behind"
    done
    deploy 0 robot@board --deb "$(package 1.1)" --config "$work/config"
    [ "$(cat "$board/etc/touchline/board.toml")" = "the new one's" ] || fail "the new configuration was not copied"
    [ "$(stat -c %a "$board/etc/touchline/team.toml")" = 644 ] || fail "the service's user cannot read the new configuration"
    [ "$(cat "$board/etc/touchline/venue.toml")" = "the hall's own" ] || fail "the venue file has changed"
    ;;
  WithoutAFrameAndAFormerPackageTheErrorIsReported)
    deploy 2 robot@board --wait 1 --deb "$(package 7.0)"
    says "camera: no such device"
    says "no earlier package"
    deploy 0 robot@board --deb "$(package 1.0)"
    echo 6 >"$board/no-camera"
    deploy 4 robot@board --deb "$(package 1.1)"
    [ "$(cat "$board/version")" = 1.0 ] || fail "the former package is not back"
    ;;
  AFailedInstallationChangesNothing)
    deploy 0 robot@board --deb "$(package 1.0)"
    deploy 1 robot@board --deb "$(package 9.0)"
    runs 1.0
    deploy 1 robot@board --deb "$(package 1.1 mips)"
    says "is for mips"
    deploy 1 robot@elsewhere --deb "$(package 1.1)"
    says "does not answer"
    deploy 1 robot@board --deb "$work/none.deb"
    deploy 64 board
    deploy 0 --help
    says "--dry-run"
    deploy 64 robot@board --wait soon
    deploy 64 robot@board --deb
    runs 1.0
    ;;
  ABrokenConnectionLeavesNoPartialState)
    deploy 0 robot@board --deb "$(package 1.0)"
    code=0
    sh "$source_dir/toolchain/deploy-on-board" "$(package 6.0)" 1 none >/dev/full 2>&1 || code=$?
    [ "$code" = 3 ] || fail "exit code $code instead of 3 when the output cannot be written"
    runs 1.0
    # A file cannot be replaced because a folder has its name.
    mkdir -p "$work/config" "$board/etc/touchline/hall.toml"
    touch "$work/config/hall.toml"
    code=0
    sh "$source_dir/toolchain/deploy-on-board" "$(package 1.1)" 1 "$work/config" >"$work/output" 2>&1 || code=$?
    [ "$code" = 3 ] || fail "exit code $code instead of 3 when the files cannot be replaced"
    runs 1.0
    [ -d "$board/etc/touchline/hall.toml" ] || fail "the former files are not back"
    ;;
  ADryRunChangesNothing)
    deploy 0 robot@board --dry-run --deb "$(package 1.0)"
    says "install 1.0"
    says "dry run"
    [ ! -e "$board/version" ] && [ ! -e "$board/state" ] && [ ! -e "$board/var" ] || fail "a dry run changed something"
    ;;
  FileNamesMayContainSpecialCharacters)
    mkdir "$work/-con fig"
    echo "the new one's" >"$work/elsewhere"
    ln -s ../elsewhere "$work/-con fig/board.toml"
    echo "is a file" >"$work/-con fig/-what's this.toml"
    package 1.0 >/dev/null
    cd "$work"
    mv -- touchline_1.0.deb "-it's 1.0.deb"
    deploy 0 robot@board --deb "-it's 1.0.deb" --config "-con fig"
    runs 1.0
    [ "$(cat "$board/etc/touchline/board.toml")" = "the new one's" ] || fail "a linked file did not arrive"
    [ -f "$board/etc/touchline/-what's this.toml" ] || fail "a file did not arrive"
    ;;
  TheServiceMustKeepRunningAfterItsFirstFrame)
    export TOUCHLINE_STEADY_S=1
    deploy 2 robot@board --deb "$(package 4.0)"
    says "the service ended soon after its first frame"
    says "camera: no such device"
    ;;
  AServiceThatWasNotReplacedIsRestarted)
    # Installed by hand: the board has no package file of this version.
    echo 1.0 >"$board/version"
    deploy 3 robot@board --deb "$(package 8.0)"
    runs 1.0
    says "a failed deployment restores nothing"
    # Neither the new nor the former package can be installed.
    deploy 0 robot@board --deb "$(package 1.1)"
    mv "$fakes/apt-get" "$fakes/no-lock"
    fake apt-get <<'END'
#!/bin/sh
case "$*" in *--download-only*) exec "$(dirname "$0")/no-lock" "$@" ;; esac
exit 100
END
    deploy 3 robot@board --deb "$(package 1.2)"
    runs 1.1
    rm "$board/var/cache/touchline/lock"
    mkdir "$board/var/cache/touchline/lock"
    deploy 1 robot@board --deb "$(package 1.2)"
    runs 1.1
    ;;
  APowerCutLosesNothing)
    deploy 0 robot@board --deb "$(package 1.0)"
    mkdir "$work/config"
    echo "the new one's" >"$work/config/board.toml"
    sh "$source_dir/toolchain/deploy-on-board" "$(package 7.0)" 20 "$work/config" >/dev/null 2>&1 &
    for ((i = 0; i < 200; ++i)); do [ "$(cat "$board/state")" = activating ] && break; sleep 0.05; done
    kill -9 $!
    wait $! 2>/dev/null || true
    flock "$board/var/cache/touchline/lock" true  # its child processes hold the lock for a moment
    [ "$(cat "$board/version" "$board/etc/touchline/board.toml")" = "$(printf "7.0\nthe new one's")" ] || fail "the deployment was not interrupted"
    echo "an hour's work" >"$board/etc/touchline/team.toml"
    deploy 3 robot@board --deb "$(package 6.0)"
    says "a failed deployment restores 1.0"
    runs 1.0
    [ "$(cat "$board/etc/touchline/board.toml")" = "the old one's" ] || fail "the former files are not back"
    [ "$(cat "$board/var/cache/touchline/aside/team.toml")" = "an hour's work" ] || fail "a file that was written in the meantime is lost"
    ;;
  AConfigurationFolderBehindALinkIsRestored)
    mv "$board/etc/touchline" "$board/data"
    ln -s ../data "$board/etc/touchline"
    deploy 0 robot@board --deb "$(package 1.0)"
    mkdir "$work/config"
    echo "the new one's" >"$work/config/board.toml"
    deploy 3 robot@board --deb "$(package 6.0)" --config "$work/config"
    [ -L "$board/etc/touchline" ] || fail "the link is gone"
    [ "$(cat "$board/data/board.toml")" = "the old one's" ] || fail "the former files are not back"
    ;;
  AnUnreachableBusIsNotTakenForAFrame)
    mv "$fakes/systemctl" "$fakes/systemd"
    fake systemctl <<'END'
#!/bin/sh
if [ "$1" = show ] && [ ! -e "$TOUCHLINE_ROOT/asked" ]; then
  touch "$TOUCHLINE_ROOT/asked"
  exit 1
fi
exec "$(dirname "$0")/systemd" "$@"
END
    deploy 2 robot@board --wait 1 --deb "$(package 7.0)"
    says "no frame in"
    ;;
  OnlyOneDeploymentRunsAtATime)
    mkdir -p "$board/var/cache/touchline"
    exec 8>"$board/var/cache/touchline/lock"
    flock 8
    deploy 1 robot@board --deb "$(package 1.0)"
    says "another deployment"
    [ ! -e "$board/version" ] || fail "something was installed"
    exec 8>&-
    deploy 0 robot@board --deb "$(package 1.0)"
    ;;
  SudoMayRequireAPassword)
    echo "open sesame" >"$board/password"
    deploy 0 robot@board --dry-run --deb "$(package 1.0)"
    says "sudo will ask for a password"
    deploy 1 robot@board --deb "$(package 1.0)" </dev/null
    says "needs a password"
    deploy 1 robot@board --deb "$(package 1.0)" <<<"sesame"
    says "rejects the password"
    [ ! -e "$board/version" ] || fail "something was installed"
    deploy 0 robot@board --deb "$(package 1.0)" <<<"open sesame"
    runs 1.0
    ! grep -rq sesame "$work/output" "$board/tmp" || fail "the password has been left behind"
    ;;
  AMissingPackageIsReportedWithTheWayToMakeIt)
    echo VERSION_CODENAME=noble >"$board/etc/os-release"
    echo amd64 >"$board/arch"
    deploy 1 robot@board
    says "no package for noble on amd64; make it on the board"
    echo armhf >"$board/arch"
    deploy 1 robot@board
    says "64-bit systems, arm64 and amd64"
    : >"$board/etc/os-release"
    deploy 1 robot@board
    : >"$board/arch"
    deploy 1 robot@board
    says "does not answer"
    ;;
  AnotherLibcameraCausesAWarning)
    deploy 0 robot@board --dry-run --deb "$(package 1.0 "" "libc6, libcamera0.4 (>= 0.4.0)")"
    ! grep -q "CSI camera" "$work/output" || fail "warns a board without Raspberry Pi's libcamera"
    echo "fact libcamera-installed libcamera0.6 0.6.0+rpt20251202-1" >"$board/libcamera"
    deploy 0 robot@board --dry-run --deb "$(package 1.0 "" "libc6, libcamera0.4 (>= 0.4.0)")"
    says "built for libcamera0.4"
    says "Raspberry Pi's libcamera0.6"
    deploy 0 robot@board --dry-run --deb "$(package 1.0 "" "libc6, libcamera0.6 (>= 0.6.0)")"
    ! grep -q "CSI camera" "$work/output" || fail "warns without need"
    ;;
  WorksOverARealSshConnection)
    # The real ssh and sshd at the ends of a pipe: quoting, exit codes, one connection for all commands.
    ssh-keygen -q -t ed25519 -N "" -f "$work/host"
    ssh-keygen -q -t ed25519 -N "" -f "$work/user"
    [ "$(/usr/bin/id -u)" -ne 0 ] || mkdir -p /run/sshd
    cat >"$work/sshd_config" <<END
HostKey $work/host
AuthorizedKeysFile $work/user.pub
StrictModes no
UsePAM no
PidFile none
SetEnv PATH=$PATH TOUCHLINE_ROOT=$board TOUCHLINE_STEADY_S=0 TMPDIR=$board/tmp
END
    cat >"$work/ssh_config" <<END
Host board
  ProxyCommand $2 -i -f $work/sshd_config -E $work/sshd_log
  IdentityFile $work/user
  IdentitiesOnly yes
  UserKnownHostsFile $work/known
  StrictHostKeyChecking accept-new
END
    rm "$fakes/ssh"
    fake ssh <<END
#!/bin/sh
exec $(PATH=${PATH#*:} command -v ssh) -F $work/ssh_config "\$@"
END
    user=$(/usr/bin/id -un)
    deploy 0 "$user@board" --deb "$(package 1.0)"
    runs 1.0
    deploy 3 "$user@board" --deb "$(package 6.0)"
    runs 1.0
    [ "$(grep -c "^Accepted publickey" "$work/sshd_log")" = 2 ] || fail "more than one connection per deployment"
    ;;
  *) echo "no such case: $1"; exit 1 ;;
esac
