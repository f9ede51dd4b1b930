@echo off
rem The panel for a class: students of the same network answer by phone, at a port that stays theirs.
cd /d "%~dp0"
crepitus.exe panel --or-sim --sessions my-lessons --lan auto --port 8443
if errorlevel 1 pause
