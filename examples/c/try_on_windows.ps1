# Builds fanuc_macro.c on Windows with the library of polycnc, runs it against a served control, and compares its lines.
#
#   powershell -ExecutionPolicy Bypass -File examples\c\try_on_windows.ps1 win32
#
# In PATH there have to be polycnc and the compiler of the target: i686-w64-mingw32-gcc for win32, x86_64-w64-mingw32-gcc for
# win64 (MSYS2: pacman -S mingw-w64-i686-gcc mingw-w64-x86_64-gcc).
param([ValidateSet("win32", "win64")][string]$Target = "win64")

$ErrorActionPreference = "Stop"
$compiler = @{ win32 = "i686-w64-mingw32-gcc"; win64 = "x86_64-w64-mingw32-gcc" }[$Target]
$folder = Join-Path ([IO.Path]::GetTempPath()) "polycnc_$Target"
$program = Join-Path $folder "fanuc_macro.exe"

& polycnc clib fanuc --target $Target -o $folder
if ($LASTEXITCODE) { exit $LASTEXITCODE }
& $compiler -std=c11 -Wall -Wextra -Werror -pedantic -I $folder -o $program (Join-Path $PSScriptRoot "fanuc_macro.c") `
    (Join-Path $folder "fwlib32.lib") -static-libgcc
if ($LASTEXITCODE) { exit $LASTEXITCODE }

$start = New-Object System.Diagnostics.ProcessStartInfo
$start.FileName = (Get-Command polycnc).Source
$start.Arguments = "calls fanuc --port 0"
$start.UseShellExecute = $false
$start.RedirectStandardOutput = $true
$start.EnvironmentVariables["PYTHONUNBUFFERED"] = "1"
$server = [System.Diagnostics.Process]::Start($start)
try {
    $env:POLYCNC_CALLS = $server.StandardOutput.ReadLine().Split(" ")[1]
    $said = @(& $program)
}
finally {
    $server.Kill()
}

$expected = @(Get-Content (Join-Path $PSScriptRoot "fanuc_macro.txt"))
$said
if (Compare-Object $expected $said -SyncWindow 0) {
    Write-Error "these are not the lines of fanuc_macro.txt"
}
"${Target}: the same lines as on other systems"
